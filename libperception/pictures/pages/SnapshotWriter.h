#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "gui-offscreen/views/Snapshot.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/pictures/pages/SnapshotViews.h"

namespace perception {

/// What is drawn of runs.
struct SnapshotOptions {
  SnapshotParams params;
  bool details = false;    ///< measurements, and ids of things
  double every = 0;        ///< [s] interval of pictures, and a contact sheet; 0: one picture
  int contact = 0;         ///< number of instants on one contact sheet
  std::string scene_file;  ///< .3Dscene of the instant, or empty
  std::vector<std::string> grid_files;  ///< safety grid of the instant, format by extension
};

/// Draws scenes of runs of one log into files. Throws DataError, OutputError, Error (kTryAgain).
class SnapshotWriter {
 public:
  /// `truth` may be null; `mark`: of the runs. Runs and truth stay until the end.
  SnapshotWriter(const std::vector<ShownRun>& shown, const GroundTruth* truth,
                 SnapshotOptions options, std::string mark)
      : shown_(shown), truth_(truth), options_(std::move(options)), mark_(std::move(mark)) {}

  std::function<void(const std::string& text, const std::string& path)> on_file;  ///< is written
  std::function<void(const std::string& text)> on_note;

  /// `output`: a file, or a folder for pictures at intervals. `chosen`: scenes of the first run.
  void drawPictures(const std::vector<std::size_t>& chosen, const std::string& output);
  void drawVideo(const std::vector<std::size_t>& chosen, const std::string& video);
  const Picture& last() const { return last_; }

 private:
  std::vector<SceneView> viewsOf(std::size_t index) const;
  std::string fileFor(const SceneView& view, const std::string& output) const;
  void write(const std::string& path, Picture picture);

  const std::vector<ShownRun>& shown_;
  const GroundTruth* truth_;
  SnapshotOptions options_;
  std::string mark_;
  Picture last_;
};

}  // namespace perception
