#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libperception/app/App.h"
#include "libperception/calibration/detectors/BoxEvidenceStudy.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/tables/StudyReport.h"
#include "libperception/pipeline/input/RecordedLog.h"

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

  std::vector<double> complete_fov{360};      ///< lidar-classes: of all logs or one a log [deg]
  bool model_only = false, variants = false;  ///< lidar-classes
  std::string license = "that of the logs", date = "not given";  ///< lidar-classes: of the model

  bool no_truth = false;  ///< gains: --no-truth

  StudyReport out_report;

  std::string name() const override { return "perception-calibrate"; }
  std::string description() const override;
  void declare(CLI::App& cli) override;
  void run() override;

 private:
  struct Task;
  static const Task kTasks[];
  /// Boxes in space of the inputs, judged by their truth; `learning`: rated on the way by
  /// confidence = learnt, each log from nothing.
  struct JudgedLogs {
    std::string sensor;
    std::map<std::string, std::string> names;  ///< the detector's class = label of the INI
    std::vector<BoxLog> logs;
  };
  JudgedLogs judgedBoxes(bool learning = false);

  StudyReport tempering();
  StudyReport boxes();
  StudyReport confidence();
  StudyReport learnt();
  StudyReport detector();
  StudyReport gains();
  StudyReport countedDetections(const std::string& include);
  GroundTruth labelsOf(const RecordedLog& log, const std::string& file) const;
  StudyReport lidarClasses();
};

}  // namespace perception
