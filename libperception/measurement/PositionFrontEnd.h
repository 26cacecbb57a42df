#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "libperception/core/Config.h"
#include "libperception/measurement/FrontEnd.h"
#include "libperception/measurement/PositionModel.h"
#include "libperception/measurement/Sensing.h"

namespace perception {

/// [sensor.LABEL.positions]: what boxes in space, or points, are worth.
struct PositionParams {
  std::vector<std::string> labels{"object"};        ///< the columns of the class tables
  std::vector<std::string> names{"object=object"};  ///< the detector's class = one of the labels
  double min_score = -1e9;
  double sigma = 0.3;      ///< [m] of the centre, each axis
  double range_share = 0;  ///< [-] more with the distance
  bool sizes = false;      ///< length, width, height and the direction of the box are measured, too
  double axis_sigma = radians(10);  ///< [rad] of that direction, front and back alike

  void visit(ParamVisitor& v);
};

/// Boxes in space as measurements of their centres: 3D detectors, GPS receivers on objects, sensors
/// that give points. Boxes are in the sensor's frame.
class PositionFrontEnd final : public FrontEnd {
 public:
  PositionFrontEnd(PositionParams params, const ClassTable& classes, const Sensing& sensing);

  MeasurementScan extract(const SensorFrame& frame) const override;
  std::vector<std::string> labelNames() const override { return params_.labels; }

 private:
  PositionParams params_;
  Modality modality_;
  std::map<std::string, int> label_of_;
  std::shared_ptr<const PositionModel> model_;
};

/// Reads [sensor.LABEL], [sensor.LABEL.class.NAME] and [sensor.LABEL.positions].
std::unique_ptr<FrontEnd> makePositionFrontEnd(Config& config, const std::string& sensor_label,
                                               const ClassTable& classes);

}  // namespace perception
