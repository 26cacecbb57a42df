#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/app/App.h"
#include "libperception/calibration/CalibrationTasks.h"
#include "libperception/evaluation/tables/StudyReport.h"

namespace perception {

/// perception-calibrate: parameters for a vehicle's INI from rawlogs with truth, each with its
/// counts.
class CalibrateApp : public App {
 public:
  std::string task;                          ///< the subcommand
  std::uint64_t seed = 1;                    ///< --seed
  int rounds = 0;                            ///< tempering: --runs; 0 = default of the task
  double seconds = 0;                        ///< of every log; 0 = all
  double truth_range = 30, truth_fov = 360;  ///< tempering: sector in which truth counts [m, deg]

  LidarClassesOptions lidar_classes{{360}, false, false, "that of the logs", "not given"};

  bool no_truth = false;  ///< gains: --no-truth

  StudyReport out_report;

  std::string name() const override { return "perception-calibrate"; }
  std::string description() const override;
  void declare(CLI::App& cli) override;
  void run() override;

 private:
  struct Task;
  static const Task kTasks[];
  CalibrationInput input() const;
};

}  // namespace perception
