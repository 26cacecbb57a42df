#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gui-offscreen/views/Snapshot.h"
#include "libperception/app/App.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/pictures/SnapshotSensors.h"
#include "libperception/pictures/pages/SnapshotWriter.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// perception-snapshot: pictures and videos of tracked runs, without a display.
class SnapshotApp : public App {
 public:
  SnapshotApp()
      : App("perception-snapshot",
            "Draws tracked runs as PNG or video: objects, sensor data, safety grid, truth.") {}

  std::vector<std::string> run_dirs;      ///< -r: folders of perception-track, runs of one log
  std::string truth_file;                 ///< -t
  std::optional<double> time;             ///< --time [s] since the log's first stamp
  std::optional<std::int64_t> frame;      ///< --frame
  std::string video;                      ///< --video: video of all scenes
  double video_from = 0, video_to = 1e9;  ///< --from, --to [s]: part of the log in the video
  std::string view;                       ///< --view: top, driver, camera joined by +; both; all
  std::vector<std::string> titles;        ///< --title: instead of the runs' names
  SnapshotOptions options;
  SnapshotSensorParams sensors;

  std::vector<std::string> out_files;  ///< written
  Picture out_picture;                 ///< the last one

  void declare(CLI::App& cli) override;
  void run() override;

 private:
  bool readConfig();  ///< true: --print-config, stop
  Config readSite(const std::string& run_dir);
  void readRuns();
  std::vector<std::size_t> chooseScenes(const TrackedRun& run) const;
  std::string titleOf(std::size_t run);
  void reportLog();

  std::vector<ShownRun> shown_;
  std::optional<GroundTruth> truth_;
};

}  // namespace perception
