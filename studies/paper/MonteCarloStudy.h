#pragma once
#include <cstdint>
#include <vector>

#include "libperception/evaluation/tables/StudyReport.h"
#include "studies/paper/PaperFilters.h"

namespace perception {

/// The simulation of [radecki2016] in which pedestrians and cyclists are classified by the
/// innovations of their filters (method.md 4.5).
struct MonteCarloParams {
  int repeats = 100;     ///< experiments ...
  int iterations = 100;  ///< ... of this many tracks per class ([radecki2016]: one of 100)
  int steps = 50;        ///< measurements per track, at 1 Hz
  bool noise_per_track =
      false;  ///< measurement sigma drawn from U(.5, 1.7) m and known to the filter
  std::uint64_t seed = 1;
};

/// Results of one experiment of `iterations` tracks per class, or means over several.
struct MonteCarloFigures {
  double nis[2][2] = {};      ///< [track: cyclist, pedestrian][filter]: mean NIS
  double chi2[2] = {};        ///< share of tracks classified correctly by the chi-square density
  double least[2] = {};       ///< ... by the smallest mean NIS
  double sequential[2] = {};  ///< ... by the sequential likelihood from the third measurement on
};

struct MonteCarloResult {
  std::vector<MonteCarloFigures> experiments;
  MonteCarloFigures mean, deviation;  ///< over experiments
  std::vector<std::vector<double>>
      traces[2];  ///< first experiment: [track][iteration][filter] mean NIS
  /// Shares classified correctly after `count` measurements: [cyclist, pedestrian].
  struct ByCount {
    int count = 0;
    double chi2[2] = {}, sequential[2] = {};
  };
  std::vector<ByCount> by_count;
};

MonteCarloResult runMonteCarlo(const MonteCarloParams& params);
/// Runs it with fixed noise and with noise drawn per track.
StudyReport monteCarloStudy(MonteCarloParams params);

}  // namespace perception
