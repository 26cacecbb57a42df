#pragma once
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "libperception/config/ParamSet.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/sensors/ego/FusionParams.h"

namespace mrpt::obs {
class CObservation;
}

namespace perception {

class EgoFusion;

/// Source of the vehicle's pose: [ego].
struct EgoPoseParams {
  /// Fusion if the log has no poses; poses of the log; fusion of GNSS, inertial unit and wheels;
  /// odometry from the scans of a lidar or of all radars, which the caller adds.
  enum class Source { kAuto, kPoses, kFusion, kLidar, kRadar };
  bool isOdometry() const { return source == Source::kLidar || source == Source::kRadar; }
  Source source = Source::kAuto;
  FusionParams fusion;
  std::string
      label;  ///< of the pose observations; empty: EGO_POSE, or the first label if there is none
  PoseUncertainty minimum;     ///< lower bounds of the standard deviations (method.md 1.3)
  double extrapolation = 0.2;  ///< [s] largest, beyond the last pose (assumed: two poses at 10 Hz)
  double max_speed = 100;      ///< [m/s] poses that imply more are jumps (assumed)
  double history = 10;         ///< [s] of stored poses (assumed)
  /// [s] without scans, in a log without ego motion, after which tracks start anew: a moving
  /// vehicle would see another static object in place of the former one, and the pair appears as a
  /// moving object (assumed).
  double blind_gap = 2;

  void visit(ParamVisitor& v);
};

/// The vehicle's pose of a CObservationRobotPose with a stamp, without its uncertainty; empty for
/// all others.
std::optional<EgoState> loggedPose(const mrpt::obs::CObservation& observation);

/// Pose of the vehicle at any recent instant: positions interpolated linearly, attitudes by slerp,
/// extrapolated for a short time with the last velocity. Poses may come in any order within the
/// history.
///
/// Without poses in the log, EgoFusion computes them from GNSS, inertial unit or wheels, until the
/// first pose of the log.
///
/// A pose that implies more than max_speed is rejected; several that agree with each other are a
/// relocation: a new world frame.
///
/// Without any of these, empty() stays true and at() returns nothing; callers then use parked():
/// the vehicle stands at the origin of the world frame.
class EgoPose {
 public:
  explicit EgoPose(EgoPoseParams params = {});
  ~EgoPose();

  /// Processes a CObservationRobotPose of the selected label and, unless `source` is kPoses, the
  /// observations of EgoFusion; others are ignored, and all with isOdometry().
  void add(const mrpt::obs::CObservation& observation);
  /// The same for a pose from another source (velocity and yaw rate are ignored).
  void add(const EgoState& pose);
  /// The ego state at `stamp`; empty when no pose is close enough in time.
  std::optional<EgoState> at(Stamp stamp) const;

  bool empty() const { return poses().empty(); }
  /// Of the oldest and the newest pose; only when not empty().
  Stamp earliest() const { return poses().front().stamp; }
  Stamp latest() const { return poses().back().stamp; }
  /// Number of changes of the world frame: when the first pose of the log replaces EgoFusion, when
  /// EgoFusion finds its heading, after a relocation. Positions in the former world frame are
  /// invalid.
  std::uint64_t frameEpoch() const;
  const EgoFusion& fusion() const { return *fusion_; }
  /// Resets, as after a jump of the clock.
  void clear();
  static EgoState parked(Stamp stamp, const PoseUncertainty& uncertainty = {});

  std::uint64_t accepted() const { return accepted_; }
  std::uint64_t rejectedJumps() const { return rejected_jumps_; }  ///< faster than max_speed
  std::uint64_t rejectedInvalid() const {
    return rejected_invalid_;
  }                                                                ///< no stamp, no place on Earth
  std::uint64_t rejectedOther() const { return rejected_other_; }  ///< too old, same instant
  std::uint64_t relocations() const { return relocations_; }  ///< rejected poses that were right

 private:
  const std::deque<EgoState>& poses() const;
  bool fused() const { return poses_.empty(); }
  bool wants(const std::string& label);
  bool isJump(const EgoState& pose);

  EgoPoseParams params_;
  std::unique_ptr<EgoFusion> fusion_;
  std::string label_;               ///< in use
  std::deque<EgoState> poses_;      ///< by stamp; velocities are not set
  std::deque<EgoState> relocated_;  ///< consecutive consistent rejected poses
  std::uint64_t accepted_ = 0, rejected_jumps_ = 0, rejected_invalid_ = 0, rejected_other_ = 0;
  std::uint64_t relocations_ = 0;
  std::uint64_t frame_epoch_ = 0;
};

}  // namespace perception
