#pragma once
#include <fstream>
#include <string>
#include <vector>

#include "libperception/core/ObjectClass.h"
#include "libperception/scene/Scene.h"

namespace perception {

/// Writes a run's scenes: tracks.csv (one line per object and scene) and scenes.csv (one line per scene: the vehicle's
/// pose, so that an empty scene is a scene, too). Fixed number format, C locale.
class TrackedRunWriter {
 public:
  /// Opens DIR/tracks.csv and DIR/scenes.csv. Throws OutputError.
  TrackedRunWriter(const std::string& dir, const ClassTable& classes, Stamp first_stamp);
  void write(const Scene& scene);
  /// Flushes and checks that everything was written (disk full). Throws OutputError with kIoError.
  void close();

 private:
  std::ofstream tracks_, scenes_;
  std::string dir_;
  ClassTable classes_;
  Stamp first_stamp_;
};

/// A run read back from its folder.
struct TrackedRun {
  std::string dir;
  Stamp first_stamp;                      ///< of the log: t = 0
  std::vector<std::string> class_names;   ///< as in the columns p_NAME
  std::vector<Scene> scenes;              ///< in order of time; objects by id; class_id indexes class_names
};

/// Throws DataError naming file, line and column.
TrackedRun readTrackedRun(const std::string& dir);

}  // namespace perception
