#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libperception/measurement/objects/ObjectClass.h"
#include "libperception/scene/Scene.h"
#include "libperception/scene/files/OutputFile.h"

namespace perception {

/// Writes a run's scenes: tracks.csv (one line per object and scene) and scenes.csv (one line per
/// scene, also for an empty one: the vehicle's pose). World frame, SI units, fixed number format, C
/// locale.
///
/// tracks.csv:
/// frame,t,stamp,id,class,classified,p_NAME...,existence,x,y,z,yaw,has_yaw,p_front,vx,vy,speed,length,width,height,
///             sd_x,sd_y,sd_yaw,sd_speed,last_hit_C,last_hit_L,last_hit_R
/// scenes.csv: frame,t,stamp,x,y,z,yaw,pitch,roll,vx,vy,yaw_rate,objects,free_distance,free_seen,
///             stop,obstacle,cause,returns,overruled,safe_speed,too_fast
/// The last nine are FreePath, empty without one; obstacle: the id of the object that covers the
/// first occupied cell, "unknown" where none does; it, cause, returns and
/// overruled are empty where the path is free.
/// t and last_hit_*: seconds since the log's first stamp; stamp: seconds since 1970; all three
/// exact to the nanosecond. last_hit_*: one column per row of modalities(), whichever sensors were
/// in use; empty if that modality has never detected the object. Decimal places: NumberFormat.h.
class TrackedRunWriter {
 public:
  /// Creates DIR/tracks.csv and DIR/scenes.csv; DIR must exist. Throws OutputError.
  TrackedRunWriter(const std::string& dir, const ClassTable& classes, Stamp first_stamp);
  /// Scenes in chronological order. An object with a value that is not finite is omitted and
  /// counted. Throws OutputError.
  void write(const Scene& scene);
  /// Flushes and checks that everything was written (disk full). Throws OutputError with kIoError.
  void close();
  /// Number of objects omitted so far because of values that are not finite: an error of the
  /// filter.
  std::uint64_t notFinite() const { return not_finite_; }

 private:
  OutputFile tracks_, scenes_;
  ClassTable classes_;
  Stamp first_stamp_;
  std::uint64_t not_finite_ = 0;
};

/// A run, read from its folder.
struct TrackedRun {
  std::string dir;
  Stamp first_stamp;                     ///< of the log: t = 0
  std::vector<std::string> class_names;  ///< of the columns p_NAME
  std::vector<Scene> scenes;  ///< in order of time; objects by id; class_id indexes class_names
};

/// Throws DataError naming file, line and column. A truncated tracks.csv is detected by the object
/// counts in scenes.csv.
TrackedRun readTrackedRun(const std::string& dir);

/// Ego state at a stamp, interpolated between scenes; empty before the first scene, after the last
/// one, or where scenes are too far apart.
std::optional<EgoState> egoAt(const TrackedRun& run, Stamp stamp);

}  // namespace perception
