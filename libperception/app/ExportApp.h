#pragma once
#include <cstdint>
#include <string>

#include "libperception/app/App.h"

namespace perception {

/// perception-export: a log and its tracks as one MCAP file.
class ExportApp : public App {
 public:
  std::string run_dir;                ///< -r: folder of perception-track
  std::string format = "foxglove";    ///< --format: foxglove, ros2, nuscenes
  std::uint64_t out_messages = 0;     ///< messages written
  std::uint64_t out_frames = 0;       ///< sensor frames among them
  std::uint64_t out_without_ego = 0;  ///< sensor frames left out: no scene near gives the pose

  std::string name() const override { return "perception-export"; }
  std::string description() const override;
  void declare(CLI::App& cli) override;
  void run() override;

 private:
  void writeTracks();
};

}  // namespace perception
