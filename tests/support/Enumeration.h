#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "tests/support/FilterWorld.h"

namespace perception::test {

/// The exact posterior of a tiny linear scene by brute force: every measurement is clutter, a birth
/// or one of the objects; every object lives or dies at every scan. Shares nothing with the filter
/// but the hash of histories.
struct ExactPosterior {
  struct TrackPosterior {
    double existence = 0;            ///< P(object is real and alive | history)
    std::vector<double> classes;     ///< P(class | real, alive, history)
    Vector2 mean = Vector2::Zero();  ///< of the position, mixture over classes
  };
  struct History {
    double probability = 0;                          ///< normalized over all histories
    std::map<std::uint64_t, TrackPosterior> tracks;  ///< by history hash of the track
  };
  double log_evidence =
      0;  ///< log p(all measurements), up to the Poisson normalizers exp(-kappa - beta)
  /// By the sorted hashes of its tracks' histories; births and clutter are not told apart (both are
  /// "new").
  std::map<std::vector<std::uint64_t>, History> histories;
};

ExactPosterior enumerateExactly(const std::vector<MeasurementScan>& scans,
                                const PositionModel& sensor, const FilterModel& model);

}  // namespace perception::test
