#pragma once
#include <map>
#include <string>
#include <vector>

#include "libperception/app/App.h"
#include "libperception/app/evaluate/RunList.h"
#include "libperception/evaluation/tables/Report.h"

namespace perception {

/// perception-evaluate: compares tracked runs with the truth of their log; table of [radecki2016]
/// and other metrics.
class EvaluateApp : public App {
 public:
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
  bool any_truth = false;      ///< --any-truth: also of another log, or where no scene has one
  bool surroundings = false;   ///< --surroundings: the truth includes poles and hedges
  std::size_t max_plots = 40;  ///< --max-plots: most truth objects with their own plot, per run
  bool nuscenes = false;       ///< --nuscenes: AMOTA and AMOTP of its tracking benchmark
  bool plots = true;           ///< --no-plots clears it
  bool without_truth = false;  ///< --without-truth: judgeQuality() in place of an evaluation

  EvaluationReport out_report;
  std::vector<std::string> out_folders;  ///< with reports

  std::string name() const override { return "perception-evaluate"; }
  std::string description() const override;
  void declare(CLI::App& cli) override;
  void run() override;

 private:
  void declareInputs(CLI::App& cli);
  void declareTruth(CLI::App& cli);
  void declareFigures(CLI::App& cli);
  std::string command() const;
  EvaluationReport emptyReport() const;
  EvaluatedRun evaluateEntry(const RunEntry& entry, const std::string& name);
  void evaluateFrontEnds(const RunEntry& entry, const GroundTruth& truth, EvaluatedRun& run);
  void evaluateRuns();
  const GroundTruth& truth(const std::string& path);
  void warnOfGaps(const EvaluatedRun& run, const std::string& truth);
  void addPaperRows();
  void judgeQuality();
  void writeReports();
  void write(EvaluationReport report, const std::string& dir);

  std::map<std::string, GroundTruth> truths_;  ///< read so far, by path
};

}  // namespace perception
