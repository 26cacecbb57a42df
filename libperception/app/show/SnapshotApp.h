#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gui-offscreen/views/Snapshot.h"
#include "libperception/app/App.h"
#include "libperception/app/show/SnapshotViews.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/pictures/SnapshotSensors.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// perception-snapshot: pictures and videos of tracked runs, without a display.
class SnapshotApp : public App {
 public:
  std::vector<std::string> run_dirs;  ///< -r: folders of perception-track, runs of one log
  std::string truth_file;             ///< -t
  std::optional<double> time;         ///< --time [s] since the log's first stamp
  std::optional<std::int64_t> frame;  ///< --frame
  double every = 0;                   ///< --every [s]: interval of pictures, and a contact sheet
  int contact = 0;                    ///< --contact: number of instants on one contact sheet
  std::string video;                  ///< --video: video of all scenes
  double video_from = 0, video_to = 1e9;  ///< --from, --to [s]: part of the log in the video
  std::string scene_file;                 ///< --scene: .3Dscene of the instant
  std::vector<std::string> grid_files;    ///< --grid: of the instant, format by extension
  std::string view;                       ///< --view: top, driver, camera joined by +; both; all
  std::vector<std::string> titles;        ///< --title: instead of the runs' names
  bool details = false;                   ///< --details: measurements, and ids of things
  SnapshotParams params;
  SnapshotSensorParams sensors;

  std::vector<std::string> out_files;  ///< written
  Picture out_picture;                 ///< the last one

  std::string name() const override { return "perception-snapshot"; }
  std::string description() const override;
  void declare(CLI::App& cli) override;
  void run() override;

 private:
  bool readConfig();  ///< true: --print-config, stop
  Config readSite(const std::string& run_dir);
  void readRuns();
  std::vector<std::size_t> chooseScenes(const TrackedRun& run) const;
  std::string titleOf(std::size_t run);
  std::vector<SceneView> viewsOf(std::size_t index) const;
  std::string fileFor(const SceneView& view) const;
  void drawPictures(const std::vector<std::size_t>& chosen);
  void drawVideo(const std::vector<std::size_t>& chosen);
  void write(const std::string& path, Picture picture);
  void reportLog();

  std::vector<ShownRun> shown_;
  std::optional<GroundTruth> truth_;
  std::string mark_;  ///< of the runs that are drawn
};

}  // namespace perception
