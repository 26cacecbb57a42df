#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gui-offscreen/Snapshot.h"
#include "libperception/app/App.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/grid/GridParams.h"
#include "libperception/lidar/GroundPlane.h"
#include "libperception/scene/TrackedRun.h"

namespace perception {

class SnapshotLidar;

/// perception-snapshot: pictures of a tracked run, without a display.
class SnapshotApp : public App {
 public:
  std::string run_dir;                ///< -r: folder of perception-track
  std::string truth_file;             ///< -t
  std::optional<double> time;         ///< --time [s] since the log's first stamp
  std::optional<std::int64_t> frame;  ///< --frame
  double every = 0;                   ///< --every [s]: a picture each, and a contact sheet
  int contact = 0;                    ///< --contact: one sheet of so many instants
  std::string view = "both";          ///< --view: top, driver or both
  std::string title;                  ///< --title: instead of the run's name
  double memory = 5;                  ///< --memory [s] of lidar scans before each instant
  SnapshotParams params;
  GridParams grid;
  GroundParams ground;

  std::vector<std::string> out_files;  ///< written
  Picture out_picture;                 ///< the last one

  std::string name() const override { return "perception-snapshot"; }
  std::string description() const override;
  void declare(CLI::App& cli) override;
  void run() override;

 private:
  bool readConfig();  ///< true: only the configuration was asked for
  std::vector<std::size_t> chooseScenes(const TrackedRun& run) const;
  std::size_t sceneAt(const TrackedRun& run, double t) const;
  std::size_t sceneOf(const TrackedRun& run, std::int64_t number) const;
  std::string titleOf(const std::string& dir);
  SceneView viewOf(const TrackedRun& run, std::size_t index) const;
  void addTruth(SceneView& view) const;
  std::string fileFor(const SceneView& view) const;
  void write(const std::string& path, Picture picture);

  std::string run_name_;
  std::optional<GroundTruth> truth_;
};

}  // namespace perception
