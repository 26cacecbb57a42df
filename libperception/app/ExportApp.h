#pragma once
#include <cstdint>
#include <string>

#include "libperception/app/App.h"

namespace perception {

/// perception-export: a log and its tracks as one MCAP file.
class ExportApp : public App {
 public:
  ExportApp()
      : App("perception-export",
            "Writes a log and its tracks as one MCAP file: for Foxglove's viewers, or as ROS 2 "
            "messages; or the tracks as a result file of nuScenes.") {}

  std::string run_dir;                ///< -r: folder of perception-track
  std::string format = "foxglove";    ///< --format: foxglove, ros2, nuscenes
  std::uint64_t out_messages = 0;     ///< messages written
  std::uint64_t out_frames = 0;       ///< sensor frames among them
  std::uint64_t out_without_ego = 0;  ///< sensor frames left out: no scene near gives the pose

  void declare(CLI::App& cli) override;
  void run() override;

 private:
  void writeTracks();
};

}  // namespace perception
