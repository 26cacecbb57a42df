#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/core/math/KalmanUpdate.h"
#include "libperception/measurement/frames/ClusterVerdicts.h"
#include "libperception/measurement/frames/PlacedReturns.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/measurement/frames/WakeMap.h"
#include "libperception/measurement/models/OcclusionMap.h"
#include "libperception/measurement/objects/EvidenceMemory.h"

namespace perception {

class MeasurementModel;

inline constexpr int kMaxAxes = 5;
using AxisVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxAxes, 1>;
using AxisMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxAxes, kMaxAxes>;
using AxisMask = std::uint8_t;  ///< bit i: axis i was seen

/// Bounding rectangle of the returns: the observed part of an object's size and orientation. A side
/// is complete when both its ends were seen.
struct PartialBox {
  double yaw = 0;                                        ///< [rad] direction of side a, world
  double yaw_sigma = 0.2;                                ///< [rad]
  double length = 0, width = 0;                          ///< [m] observed, along and across yaw
  bool length_complete = false, width_complete = false;  ///< both ends of that side were seen
  double length_sigma = 0, width_sigma = 0;  ///< [m] of complete sides; 0: the filter's side_sigma
  Vector2 center = Vector2::Zero();          ///< [m] of the box, world
  /// Log-odds that yaw points to the front of a car and not to its rear, by the shape of the car;
  /// 0: unknown.
  double front_log_odds = 0;
};

/// Heading measured by a detector that may confuse front and back: the axis has the deviation
/// `sigma`, the direction is reversed with `flip_probability` (method.md 7).
struct MeasuredHeading {
  double yaw = 0;                 ///< [rad] world
  double sigma = 0.14;            ///< [rad] of the axis; 8 deg, method.md 7
  double flip_probability = 0.2;  ///< in [0, 0.5]; at 0.5 only the axis is measured
  /// P(reversed | the detector's heading of this object before was reversed): reversals come in
  /// bursts. Up to flip_probability: they are independent.
  double flip_persistence = 0;
};

/// What a range rate, or the ranges of two scans, say about the velocity: the component along the
/// line of sight and, where the sensor configuration bounds it, the spread of the component across
/// the line of sight.
struct RadialSpeed {
  Vector2 direction = Vector2::UnitX();  ///< unit vector away from the sensor, world frame
  ScalarEstimate along;                  ///< value [m/s] and variance [m^2/s^2]
  std::optional<double> across_sigma;    ///< [m/s]; if empty, that of the class is used
};

/// What the shape of a cluster says of whether it is a phantom (method.md 5.19).
struct PhantomLook {
  double cause = 0;        ///< [0, 1] P(something makes phantoms at its place), above 0
  double probability = 0;  ///< [0, cause] P(phantom) by its shape and this cause
  double evidence = 0;     ///< log p(shape | phantom) / p(shape | anything else)
};

/// z with covariance R under the scan's MeasurementModel, and the other attributes of the
/// detection.
struct Measurement {
  AxisVector z;                ///< one value per axis of the model; axes not seen hold 0
  AxisMatrix R;                ///< covariance of z, pose uncertainty included; rows not seen hold 0
  AxisMask seen = 0;           ///< axes that enter likelihood, clutter and birth density
  int label = 0;               ///< index into the model's labels
  double log_score_ratio = 0;  ///< log p(score | object) / p(score | clutter)
  /// log p(labels, scores | class, detected) by class and for clutter, for detectors with a score
  /// per label. Empty: the model's label table and `log_score_ratio`.
  std::vector<double> log_class;
  double log_clutter = 0;
  std::optional<PhantomLook> phantom;    ///< empty: no cluster told by its shape, or no cause
  std::optional<EvidenceView> view;      ///< of `log_class`; empty: its errors are independent
  Vector2 position = Vector2::Zero();    ///< [m] approximate position of the object, world: for
                                         ///< gating by distance and for drawings
  double position_sigma = 1;             ///< [m] its standard deviation
  std::optional<ScalarEstimate> base_z;  ///< [m] lowest point of the object, world
  std::optional<ScalarEstimate> height;  ///< [m] lowest to highest point
  std::optional<PartialBox> sides;
  std::optional<MeasuredHeading> heading;  ///< used by classes with a heading
  /// Of a lidar's cluster, by two scans: for objects whose velocity is not known yet.
  std::optional<RadialSpeed> radial_speed;
  int detection = -1;  ///< index of the detection in its frame
};

/// Multiplies all standard deviations of the measurement by a factor above 0.
void scaleNoise(Measurement& measurement, double factor);

/// Sensor and vehicle at the time of a scan.
struct SensorState {
  Stamp stamp;
  Pose3 T_world_sensor = Pose3::Identity();
  EgoState ego;
};

/// All measurements from one sensor at one instant. Never mixes sensors.
struct MeasurementScan {
  std::string sensor;  ///< label
  Modality modality = Modality::kLidar;
  std::int64_t frame = -1;  ///< the log's frame number
  SensorState state;
  std::shared_ptr<const MeasurementModel> model;
  std::shared_ptr<const OcclusionMap> occlusion;  ///< null: nothing is occluded
  std::shared_ptr<const WakeMap> wakes;           ///< null: no phantoms in wakes
  std::shared_ptr<const PlacedReturns> returns;   ///< of a lidar; null: none
  std::optional<ClusterVerdicts> verdicts;        ///< empty: no clusters told by their shape
  std::vector<Measurement> measurements;
  std::size_t dropped = 0;  ///< detections that could not be used: unknown label, invalid box
  std::size_t dropped_points =
      0;  ///< lidar returns without a range, and those beyond the front end's limit per scan
};

}  // namespace perception
