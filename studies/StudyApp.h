#pragma once
#include <cstdint>
#include <string>

#include "libperception/app/App.h"
#include "libperception/evaluation/tables/StudyReport.h"
#include "studies/obstacles/ObstaclesStudy.h"
#include "studies/obstacles/SafetyStudy.h"
#include "studies/paper/PaperStudy.h"
#include "studies/resolution/ResolutionStudy.h"
#include "studies/weather/TrustStudy.h"
#include "studies/weather/WeatherStudy.h"

namespace perception {

/// perception-study: experiments on the method, each with a report of tables and plots.
class StudyApp : public App {
 public:
  StudyApp()
      : App("perception-study",
            "Experiments on the method: each writes a report with tables and plots.") {}

  std::string study;                ///< the name of the experiment
  std::uint64_t seed = 1;           ///< --seed
  int runs = 0;                     ///< --runs; 0 = default of the study
  double seconds = 0;               ///< labels: of every log; 0 = all
  double range = 40, fov_deg = 80;  ///< labels: where truth counts [m, deg]
  ResolutionOptions resolution;     ///< resolution: all of its options
  PaperOptions paper;               ///< paper: all of its options
  TrustOptions trust;               ///< trust: all of its options
  WeatherOptions weather;           ///< weather: all of its options
  SafetyOptions safety;             ///< safety: all of its options
  ObstaclesOptions obstacles;       ///< obstacles: all of its options
  double snow_mm_h = 2.5;           ///< snow-realism: of the control

  StudyReport out_report;

  void declare(CLI::App& cli) override;
  void run() override;

  void declareLabels(CLI::App& sub);
  /// The labels study on the logs of -i.
  StudyReport labelsOfLogs();
  void declareSnow(CLI::App& sub);
  /// The snow study on the logs of -i, the first one recorded.
  StudyReport snowOfLogs();
};

}  // namespace perception
