#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/KalmanUpdate.h"
#include "libperception/core/Time.h"
#include "libperception/measurement/OcclusionMap.h"
#include "libperception/measurement/SensorFrame.h"

namespace perception {

class MeasurementModel;

inline constexpr int kMaxAxes = 5;
using AxisVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxAxes, 1>;
using AxisMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxAxes, kMaxAxes>;
using AxisMask = std::uint8_t;  ///< bit i: axis i was seen

/// Sides of a box about the returns: what was seen of the object's size and orientation. Not every
/// side is complete.
struct PartialBox {
  double yaw = 0;                                        ///< [rad] direction of side a, world
  double yaw_sigma = 0.2;                                ///< [rad]
  double length = 0, width = 0;                          ///< [m] seen length along and across yaw
  bool length_complete = false, width_complete = false;  ///< both ends of that side were seen
  double length_sigma = 0, width_sigma = 0;  ///< [m] of complete sides; 0: the filter's side_sigma
  Vector2 center = Vector2::Zero();          ///< [m] of the box, world
};

/// What a detector says of an object's heading. It may confuse front and back: the axis is measured
/// with `sigma`, its direction is reversed with `flip_probability` (method.md 7).
struct MeasuredHeading {
  double yaw = 0;                 ///< [rad] world
  double sigma = 0.14;            ///< [rad] of the axis; method.md 7: 8 deg
  double flip_probability = 0.2;  ///< in [0, 0.5]: 0.5 tells the axis alone
  /// P(reversed | the detector's heading of this object before was reversed): reversals come in
  /// bursts. No more than flip_probability: they do not.
  double flip_persistence = 0;
};

/// z with covariance R under the scan's MeasurementModel, and what else the detection says of its
/// object.
struct Measurement {
  AxisVector z;                ///< one value an axis of the model; axes not seen hold 0
  AxisMatrix R;                ///< covariance of z, pose uncertainty included; rows not seen hold 0
  AxisMask seen = 0;           ///< which axes count, in likelihood, clutter and birth density alike
  int label = 0;               ///< index into the model's labels
  double log_score_ratio = 0;  ///< log p(score | object) / p(score | clutter)
  /// log p(labels, scores | class, detected) by class and for clutter, of detectors that score
  /// every label on its own. Empty: the model's label table and `log_score_ratio`.
  std::vector<double> log_class;
  double log_clutter = 0;
  Vector2 position = Vector2::Zero();    ///< [m] rough place of the object, world: for gating by
                                         ///< distance and pictures
  double position_sigma = 1;             ///< [m] how rough
  std::optional<ScalarEstimate> base_z;  ///< [m] lowest point of the object, world
  std::optional<ScalarEstimate> height;  ///< [m] lowest to highest point
  std::optional<PartialBox> sides;
  std::optional<MeasuredHeading> heading;  ///< of classes with a heading only
  int detection = -1;                      ///< index of the detection in its frame
};

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
  std::shared_ptr<const OcclusionMap> occlusion;  ///< what occludes what; null: nothing
  std::vector<Measurement> measurements;
  std::size_t dropped =
      0;  ///< detections that could not be used: no such label, a box that is none
  std::size_t dropped_points =
      0;  ///< returns of a lidar without a range, and those above the front end's limit of a scan
};

}  // namespace perception
