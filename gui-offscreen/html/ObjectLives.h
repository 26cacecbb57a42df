#pragma once
#include <cstdint>
#include <vector>

#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// Lifetime of one object in a run.
struct ObjectLife {
  std::uint64_t id = 0;
  /// A time interval with one class.
  struct Stretch {
    double from = 0, to = 0;  ///< [s] of the log, `to` one scene after the last
    ClassId class_id = 0;
    bool sure = false;
  };
  std::vector<Stretch> stretches;
  ClassId last_class = 0;
  double probability = 0;               ///< of that class, at the end
  double last_seen = 0;                 ///< [s] of the log: its last scene
  double top_speed = 0, nearest = 1e9;  ///< [m/s], [m] from the ego origin
  double from() const { return stretches.front().from; }
  double to() const { return stretches.back().to; }
};

/// All objects of a run by id. Gaps of more than two scene periods start a new interval.
std::vector<ObjectLife> objectLives(const TrackedRun& run);

}  // namespace perception
