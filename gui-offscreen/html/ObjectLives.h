#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "libperception/scene/Scene.h"
#include "libperception/scene/files/TrackedRunReader.h"

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

/// Collects the lifetimes of a run's objects. Gaps of more than two scene periods start a new
/// interval.
class ObjectLives {
 public:
  explicit ObjectLives(const RunOutline& run);
  /// Scenes in order of time.
  void add(const Scene& scene);
  /// All objects by id.
  std::vector<ObjectLife> list() const;

 private:
  Stamp first_stamp_;
  double period_ = 0.1;  // [s] between scenes, mean
  std::map<std::uint64_t, ObjectLife> lives_;
};

}  // namespace perception
