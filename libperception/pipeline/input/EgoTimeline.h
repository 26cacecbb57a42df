#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "libperception/odometry/LidarOdometry.h"
#include "libperception/odometry/RadarOdometry.h"
#include "libperception/scene/files/EventLog.h"
#include "libperception/sensors/ego/EgoPose.h"

namespace perception {

/// Ego state at the stamps of frames, also if poses are missing: before the first one, in gaps, in
/// logs without poses (method.md 1.4). Reports gaps as events.
class EgoTimeline {
 public:
  EgoTimeline(const EgoPoseParams& params, EventLog& events)
      : params_(params), events_(events), pose_(params) {}

  /// Reports rejected poses, each run of them once.
  void add(const mrpt::obs::CObservation& observation);
  /// The pose at a scan, with [ego] source = lidar (method.md 1.7); no effect otherwise. Scans in
  /// order of time, of one lidar. Reports scans that could not be registered, each run of them
  /// once.
  void addScan(const SensorFrame& frame);
  /// True at the first call after a change of the world frame, if a frame was used before: the
  /// tracks are in the former world frame and must be deleted.
  bool changedFrame(Stamp stamp);
  /// True when the log has no pose so far and the last frame was used more than blind_gap ago. The
  /// tracks must then be deleted: without poses the vehicle is assumed to stand still, and if it
  /// moved in the gap, measurements would be associated with wrong tracks.
  bool isBlindGap(Stamp stamp);
  /// The same with [ego] source = radar, from all radar frames of an instant (method.md 1.8).
  void addRadars(const std::vector<const SensorFrame*>& frames);
  /// True while odometry has no motion yet, for a second at most: the vehicle may be fast, so no
  /// frame is used before.
  bool isStarting(Stamp stamp);
  EgoState at(Stamp stamp);
  /// A frame of this stamp was used.
  void setSeen(Stamp stamp) { last_seen_ = stamp; }
  /// Clears all state, as after a clock jump.
  void clear();

 private:
  EgoPoseParams params_;
  EventLog& events_;
  EgoPose pose_;
  LidarOdometry odometry_;
  RadarOdometry radar_odometry_;
  std::optional<Stamp> last_seen_;
  std::optional<Stamp> start_;     ///< of the odometry
  std::uint64_t frame_epoch_ = 0;  ///< EgoPose::frameEpoch() of the tracks
  bool none_reported_ = false;     ///< the event "no pose yet"
  bool in_gap_ = false, in_jump_ = false, in_invalid_ = false, in_lost_ = false;
};

}  // namespace perception
