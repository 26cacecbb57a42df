#pragma once
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "libperception/config/ParamSet.h"
#include "libperception/measurement/SensorFrame.h"
#include "libperception/sensors/FusionParams.h"

namespace mrpt::obs {
class CObservation;
}

namespace perception {

class EgoFusion;

/// How the vehicle's pose is taken from the log: [ego].
struct EgoPoseParams {
  /// Poses of the log, or satellites, inertial unit and wheels, or these where no pose is.
  enum class Source { kAuto, kPoses, kFusion };
  Source source = Source::kAuto;
  FusionParams fusion;
  std::string
      label;  ///< of the pose observations; empty: EGO_POSE, or the first label if there is none
  PoseUncertainty minimum;     ///< method.md 1.3; a log that claims less (or nothing) gets this
  double extrapolation = 0.2;  ///< [s] at most beyond the last pose (assumed: two poses at 10 Hz)
  double max_speed = 100;      ///< [m/s] a step that implies more is a jump (assumed)
  double history = 10;         ///< [s] of poses that are kept (assumed)
  /// [s] without any scan, while nothing tells how the vehicle moves, after which tracks start
  /// anew: at 5 m/s another bush stands then where one was, and the pair looks like a runner
  /// (assumed).
  double blind_gap = 2;

  void visit(ParamVisitor& v);
};

/// Where the vehicle was at any instant of the recent past: positions in between linearly,
/// attitudes by slerp, beyond the newest pose for a moment with the last velocity. Poses may come
/// in any order within the history.
///
/// A log without poses but with a satellite receiver, an inertial unit or wheels gets them from
/// EgoFusion; the first pose of the log ends that.
///
/// A log without any of them: empty() stays true and at() gives nothing; callers then use parked(),
/// the documented fallback: the vehicle stands at the world's origin.
class EgoPose {
 public:
  explicit EgoPose(EgoPoseParams params = {});
  ~EgoPose();

  /// Takes a CObservationRobotPose of the wanted label and, unless `source` is poses, what
  /// EgoFusion takes; every other observation is ignored.
  void add(const mrpt::obs::CObservation& observation);
  /// The same for a pose from elsewhere (velocity and yaw rate are ignored).
  void add(const EgoState& pose);
  /// The vehicle at `stamp`; empty when no pose is near enough in time.
  std::optional<EgoState> at(Stamp stamp) const;

  bool empty() const { return poses().empty(); }
  /// Of the newest pose; only when not empty().
  Stamp latest() const { return poses().back().stamp; }
  /// How often the world of the poses became another one: when the first pose of the log took over
  /// from EgoFusion, or this one found its heading. What was placed in the old world is void.
  std::uint64_t frameEpoch() const;
  const EgoFusion& fusion() const { return *fusion_; }
  /// Forgets everything, as after a jump of the clock.
  void clear();
  static EgoState parked(Stamp stamp, const PoseUncertainty& uncertainty = {});

  std::uint64_t accepted() const { return accepted_; }
  std::uint64_t rejectedJumps() const { return rejected_jumps_; }  ///< faster than max_speed
  std::uint64_t rejectedOther() const {
    return rejected_other_;
  }  ///< bad stamp or numbers, too old, same instant

 private:
  const std::deque<EgoState>& poses() const;
  bool fused() const { return poses_.empty(); }
  bool wants(const std::string& label);
  bool isJump(const EgoState& pose);
  void setMotion(EgoState& state) const;

  EgoPoseParams params_;
  std::unique_ptr<EgoFusion> fusion_;
  std::string label_;               ///< in use
  std::deque<EgoState> poses_;      ///< by stamp; velocities are not set
  std::deque<EgoState> relocated_;  ///< a run of rejected poses that agree with each other
  std::uint64_t accepted_ = 0, rejected_jumps_ = 0, rejected_other_ = 0;
  std::uint64_t frame_epoch_ = 0;
};

}  // namespace perception
