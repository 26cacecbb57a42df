#pragma once
#include <string>
#include <vector>

#include "libperception/app/App.h"
#include "libperception/evaluation/tables/Report.h"

namespace perception {

/// perception-evaluate: compares tracked runs with the truth of their log; table of [radecki2016]
/// and other metrics.
class EvaluateApp : public App {
 public:
  EvaluateApp()
      : App("perception-evaluate",
            "Compares tracked runs with the truth of their log: table of Radecki et al., GOSPA, "
            "false objects, calibration, front ends, plots; several runs side by side or pooled.") {
  }

  std::vector<std::string> runs;  ///< -r: folders of perception-track, or CONDITION=PATTERN of such
  std::string
      truth_file;  ///< -t; {log} and {run} are replaced by the names of a run's log and folder
  std::string truth_poses;              ///< --truth-poses: run with the poses of the truth's world
  std::string manifest;                 ///< --manifest: CSV with the columns condition, run, truth
  std::string reference;                ///< --reference: reference run of the number of objects
  std::vector<std::string> front_ends;  ///< --front-end: labels of sensors, or patterns of them
  std::vector<std::string> paper;       ///< --paper: tables of [radecki2016] to list for comparison
  EvaluationOptions params;
  double fov_deg = 180, complete_fov_deg = 360;
  bool any_truth = false;     ///< --any-truth: also of another log, or where no scene has one
  bool surroundings = false;  ///< --surroundings: the truth includes poles and hedges
  static constexpr std::size_t kMostPlots = 40;  ///< of single truth objects, for each run
  bool nuscenes = false;       ///< --nuscenes: AMOTA and AMOTP of its tracking benchmark
  bool plots = true;           ///< --no-plots clears it
  bool without_truth = false;  ///< --without-truth: judgeQuality() in place of an evaluation

  EvaluationReport out_report;
  std::vector<std::string> out_folders;  ///< with reports

  void declare(CLI::App& cli) override;
  void run() override;

 private:
  void declareInputs(CLI::App& cli);
  void declareTruth(CLI::App& cli);
  void declareFigures(CLI::App& cli);
  std::string command() const;
  void evaluateRuns();
  void judgeQuality();
};

}  // namespace perception
