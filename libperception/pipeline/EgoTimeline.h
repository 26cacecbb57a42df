#pragma once
#include <cstdint>
#include <optional>

#include "libperception/scene/EventLog.h"
#include "libperception/sensors/EgoPose.h"

namespace perception {

/// The vehicle at the instants of the frames, also where its pose is missing: before the first one,
/// in gaps, in logs without any (method.md 1.4). Reports gaps as events.
class EgoTimeline {
 public:
  EgoTimeline(const EgoPoseParams& params, EventLog& events)
      : params_(params), events_(events), pose_(params) {}

  void add(const mrpt::obs::CObservation& observation) { pose_.add(observation); }
  /// True once after the world frame changed while tracks were about: in another one they are
  /// nowhere.
  bool changedFrame(Stamp stamp);
  /// True when nothing was seen for longer than blind_gap and no pose tells how the vehicle moved:
  /// a vehicle that is only taken to stand may be anywhere after a while. What is seen now would be
  /// paired with what stood there before, and look as if it had run.
  bool isBlindGap(Stamp stamp);
  EgoState at(Stamp stamp);
  /// Frames of this instant were used.
  void setSeen(Stamp stamp) { last_seen_ = stamp; }
  /// Forgets everything, as after a jump of the clock.
  void clear();

 private:
  EgoPoseParams params_;
  EventLog& events_;
  EgoPose pose_;
  std::optional<Stamp> last_seen_;
  std::uint64_t frame_epoch_ = 0;  ///< EgoPose::frameEpoch() that the tracks live in
  bool none_reported_ = false;     ///< that there is no pose yet
  bool in_gap_ = false;
};

}  // namespace perception
