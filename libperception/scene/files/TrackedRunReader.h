#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/measurement/objects/ObjectClass.h"
#include "libperception/scene/Scene.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

std::string tracksFileOf(const std::string& dir);
std::string scenesFileOf(const std::string& dir);
/// Name of the column with the last measurement by a modality.
std::string lastHitColumn(const ModalityRow& modality);

/// Names of FreePath::Cause in scenes.csv.
inline constexpr std::array<const char*, 3> kPathCauses = {"grid", "returns", "object"};

/// Reads the folder of a run scene by scene: its memory does not grow with the run.
class TrackedRunReader {
 public:
  /// Throws DataError naming file, line and column; so does next().
  explicit TrackedRunReader(const std::string& dir);
  ~TrackedRunReader();

  /// The next scene in order of time; empty after the last. A truncated tracks.csv is detected by
  /// the object counts in scenes.csv.
  std::optional<Scene> next();
  /// At most `count` scenes more.
  std::vector<Scene> next(std::size_t count);

  Stamp firstStamp() const;  ///< of the log: t = 0
  const std::vector<std::string>& classNames() const;

 private:
  struct Tables;
  std::unique_ptr<Tables> tables_;
};

/// What is known of a run before its scenes are read.
struct RunOutline {
  std::string dir;
  Stamp first_stamp;                     ///< of the log: t = 0
  std::vector<std::string> class_names;  ///< of the columns p_NAME
  std::vector<Stamp> stamps;             ///< of the scenes
};

/// Throws DataError.
RunOutline readRunOutline(const std::string& dir);

}  // namespace perception
