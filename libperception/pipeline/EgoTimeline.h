#pragma once
#include <cstdint>
#include <optional>

#include "libperception/scene/EventLog.h"
#include "libperception/sensors/EgoPose.h"

namespace perception {

/// Ego state at the stamps of frames, also where poses are missing: before the first one, in gaps,
/// in logs without poses (method.md 1.4). Reports gaps as events.
class EgoTimeline {
 public:
  EgoTimeline(const EgoPoseParams& params, EventLog& events)
      : params_(params), events_(events), pose_(params) {}

  void add(const mrpt::obs::CObservation& observation) { pose_.add(observation); }
  /// True once after the world frame has changed, so that all tracks must be deleted.
  bool changedFrame(Stamp stamp);
  /// True when there was no frame for longer than blind_gap and no pose: the vehicle is then only
  /// assumed to stand still, so that new measurements could be associated with tracks at wrong
  /// places.
  bool isBlindGap(Stamp stamp);
  EgoState at(Stamp stamp);
  /// A frame of this stamp was used.
  void setSeen(Stamp stamp) { last_seen_ = stamp; }
  /// Clears all state, as after a clock jump.
  void clear();

 private:
  EgoPoseParams params_;
  EventLog& events_;
  EgoPose pose_;
  std::optional<Stamp> last_seen_;
  std::uint64_t frame_epoch_ = 0;  ///< EgoPose::frameEpoch() of the tracks
  bool none_reported_ = false;     ///< the event "no pose yet"
  bool in_gap_ = false;
};

}  // namespace perception
