#pragma once
#include <cstdint>
#include <string>

#include "libperception/app/App.h"
#include "libperception/study/Study.h"

namespace perception {

/// perception-study: experiments about the method, each a report with tables and plots.
class StudyApp : public App {
 public:
  std::string study;       ///< the name of the experiment
  std::uint64_t seed = 1;  ///< --seed
  int runs = 0;            ///< --runs; 0 = the study's own number
  std::string folder;      ///< gps: recordings by class
  std::string stationary;  ///< gps: recording of a receiver at rest

  StudyReport out_report;

  std::string name() const override { return "perception-study"; }
  std::string description() const override;
  void declare(CLI::App& cli) override;
  void run() override;

 private:
  void writeReport();
};

}  // namespace perception
