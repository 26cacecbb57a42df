#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/measurement/frames/FrontEnd.h"
#include "libperception/radar/RadarModel.h"

namespace perception {

/// [sensor.LABEL.radar]: noise, mounting and clustering of one unit. Defaults: a modern 77 GHz
/// unit, assumed (method.md 4.3); DUC's Delphi had 5 m, 5 deg, 1 m/s [cornell2007].
struct RadarParams {
  double range_sigma = 0.5;           ///< [m]
  double bearing_sigma = radians(2);  ///< [rad]
  double rate_sigma = 0.15;           ///< [m/s]
  double own_speed_sigma = 0.1;       ///< [m/s] of the vehicle's velocity in any direction; assumed
  bool upside_down = false;  ///< mounted upside down, which its pose in the log does not include
  // Returns of one object in one scan are merged: from the strongest on, each takes the returns
  // within these distances (cell of method.md 9.9; assumed, 8.7), without chaining along a row of
  // cars.
  double merge_range = 0.75;       ///< [m]
  double merge_width = 1.0;        ///< [m] across the line of sight, at least bearing_sigma there
  double merge_rate = 0.5;         ///< [m/s]
  bool drop_double_bounce = true;  ///< object - own vehicle - object: twice the range and rate
  RadarModelParams model;

  void visit(ParamVisitor& v);
};

/// Returns that are merged into one reflector.
struct RadarTarget {
  double range = 0, bearing = 0;  ///< [m] on the ground, [rad] off forward in the level frame
  double range_rate = 0;          ///< [m/s] on the ground; see has_rate
  bool has_rate = false;
  double range_spread = 0, bearing_spread = 0;  ///< [m, rad] standard deviation of its returns
  int strongest = -1;                           ///< index of its strongest return in the frame
  int returns = 0;
};

/// The radar front end: the targets of one scan as measurements under a RadarModel. Invalid returns
/// are dropped and counted.
class RadarFrontEnd final : public FrontEnd {
 public:
  RadarFrontEnd(RadarParams params, const ClassTable& classes,
                const DetectionModel& detection_model);

  std::vector<std::string> labelNames() const override {
    return model_->detection_model().labels();
  }

  const RadarParams& params() const { return params_; }

 protected:
  Modality modality() const override { return model_->detection_model().params().modality; }
  std::shared_ptr<const MeasurementModel> model() const override { return model_; }
  Pose3 measuringPose(const SensorFrame& frame) const override;
  void fill(const SensorFrame& frame, MeasurementScan& scan) const override;

 private:
  std::optional<Measurement> measure(const RadarTarget& target, const SensorState& state) const;

  RadarParams params_;
  std::shared_ptr<const RadarModel> model_;
};

/// The targets in the level frame (x along the unit's forward axis, z up): double bounces removed,
/// returns of one object merged. Adds the number of invalid returns to `dropped`.
std::vector<RadarTarget> radarTargets(const RadarReturns& data, const Pose3& T_level_sensor,
                                      const RadarParams& params, std::size_t& dropped);

/// Reads [sensor.LABEL], [sensor.LABEL.class.NAME] and [sensor.LABEL.radar].
std::unique_ptr<FrontEnd> makeRadarFrontEnd(Config& config, const std::string& sensor_label,
                                            const ClassTable& classes);

}  // namespace perception
