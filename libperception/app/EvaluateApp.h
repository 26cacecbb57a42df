#pragma once
#include <string>
#include <vector>

#include "libperception/app/App.h"
#include "libperception/evaluation/Report.h"

namespace perception {

/// perception-evaluate: holds tracked runs against the truth of their log and reports the paper's
/// table and more.
class EvaluateApp : public App {
 public:
  std::vector<std::string> runs;  ///< -r: folders of perception-track
  std::string truth_file;         ///< -t
  std::string
      reference;  ///< --reference: a run whose number of objects the others are compared with
  EvaluationOptions params;
  double fov_deg = 180, complete_fov_deg = 360;
  std::size_t max_plots =
      40;             ///< --max-plots: truth objects with a picture of their own, for each run
  bool plots = true;  ///< --no-plots clears it

  EvaluationReport out_report;
  std::vector<std::string> out_folders;  ///< where reports were written

  std::string name() const override { return "perception-evaluate"; }
  std::string description() const override;
  void declare(CLI::App& cli) override;
  void run() override;

 private:
  std::string command() const;
  EvaluationReport emptyReport() const;
  void evaluateRuns();
  void warnOfGaps(const EvaluatedRun& run);
  void writeReports();
  void write(EvaluationReport report, const std::string& dir);
};

}  // namespace perception
