#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// The vehicle's motion in its own frame.
struct RadarMotion {
  Vector3 mean = Vector3::Zero();  ///< vx, vy [m/s], yaw rate [rad/s]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  std::size_t standing = 0;  ///< targets of the last instant that it explains
};

/// The vehicle's motion from the range rates of standing things, seen by all radars
/// (method.md 1.8). It takes the largest group of an instant's targets that one motion explains,
/// then updates the motion robustly. The result is a function of the frames alone.
class RadarOdometry {
 public:
  /// Radar frames of one instant. Pose of the vehicle at their stamp in the world frame, that of
  /// the vehicle at the first instant, with the uncertainty of the last step. Empty without a
  /// target that has a rate, and for stamps that are not later than the last.
  std::optional<EgoState> update(const std::vector<const SensorFrame*>& frames);
  const RadarMotion& motion() const { return motion_; }
  /// Number of instants whose targets fit no motion near the one before: that went on.
  std::uint64_t lost() const { return lost_; }
  void clear() { *this = RadarOdometry(); }

 private:
  /// A target: rate = row . (vx, vy, yaw rate), if it stands.
  struct Row {
    Vector3 row = Vector3::Zero();
    double rate = 0;  ///< [m/s]
  };
  static void addRows(const SensorFrame& frame, std::vector<Row>& rows);
  static std::optional<Vector3> searched(const std::vector<Row>& rows);
  void predict(double dt);
  bool correct(const std::vector<Row>& rows);

  RadarMotion motion_;
  bool known_ = false;
  int unexplained_ = 0;  ///< instants in a row
  Pose3 T_world_ego_ = Pose3::Identity();
  std::optional<Stamp> stamp_;
  std::uint64_t lost_ = 0;
};

}  // namespace perception
