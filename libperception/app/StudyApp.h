#pragma once
#include <cstdint>
#include <string>

#include "libperception/app/App.h"
#include "libperception/app/ResolutionStudy.h"
#include "libperception/study/RecordedLog.h"
#include "libperception/study/Study.h"

namespace perception {

/// perception-study: experiments about the method, each a report with tables and plots.
class StudyApp : public App {
 public:
  std::string study;                 ///< the name of the experiment
  std::uint64_t seed = 1;            ///< --seed
  int runs = 0;                      ///< --runs; 0 = the study's own number
  std::string folder;                ///< gps: recordings by class
  std::string stationary;            ///< gps: recording of a receiver at rest
  std::string log;                   ///< particles: a rawlog instead of simulated positions
  std::string duc_config;            ///< particles: --duc, INI of DUC's tracker
  std::string truth_file;            ///< particles: --truth of the log
  std::vector<int> counts;           ///< particles: of the log; empty = the paper's
  double seconds = 0;                ///< particles: of the log; 0 = all
  double range = 30, fov_deg = 360;  ///< particles: where objects of a log count [m, deg]
  std::string scenario;              ///< ego: INI of the scenario
  ResolutionOptions resolution;      ///< resolution: all of its options
  double labels_range = 40, labels_fov_deg = 80;         ///< labels: where truth counts [m, deg]
  double tempering_range = 30, tempering_fov_deg = 360;  ///< tempering: the same

  StudyReport out_report;

  std::string name() const override { return "perception-study"; }
  std::string description() const override;
  void declare(CLI::App& cli) override;
  void run() override;

  /// The study of a log, for --log.
  StudyReport particlesOfLog();
  /// Labels of a detector, on the logs of -i.
  StudyReport labelsOfLogs();
  /// Exponents of the class update, on the logs of -i.
  StudyReport temperingOfLogs();
  /// Evidence of a 3D detector's boxes, on the logs of -i.
  StudyReport boxesOfLogs();
  /// What detectors see of labelled objects, on the logs of -i.
  StudyReport detectorsOfLogs();

 private:
  void declareRecordings(CLI::App& sub);
  void declareLog(CLI::App& sub);
  void declareLabels(CLI::App& sub);
  void declareTempering(CLI::App& sub);
  /// What studies of several rawlogs share; `range_of` [m], `fov` [deg]: where truth counts.
  void addLogsOptions(CLI::App& sub, double& range_of, double& fov);
  RecordedLog record(const std::string& config);
  void writeReport();
};

}  // namespace perception
