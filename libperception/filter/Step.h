#pragma once
#include <vector>

#include "libperception/core/math/Random.h"
#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"

namespace perception {

/// Counters of one step, for reports.
struct StepStats {
  std::size_t hypotheses = 0;       ///< distinct hypotheses after the step
  std::size_t distinct_tracks = 0;  ///< distinct tracks of the hypotheses before the step
  std::size_t predicted = 0;        ///< distinct tracks predicted to the scan's stamp and scored
  std::size_t pairs = 0;            ///< gated track-measurement pairs
  std::size_t measurements = 0;
  std::size_t updates = 0;  ///< distinct updated tracks
  /// [0, 1] by measurement: posterior probability that a track of before the scan is its cause.
  std::vector<double> of_tracks;
};

/// The posterior: weighted hypotheses, one slot a particle. With the sampled proposal, slots of
/// equal history share a hypothesis; with the ranked one, all histories differ.
struct Posterior {
  std::vector<HypothesisHandle> hypotheses;
  std::vector<double> log_weights;  ///< not normalized

  /// `n` empty hypotheses of equal weight.
  static Posterior empty(std::size_t n);
};

struct StepResult {
  Posterior posterior;
  StepStats stats;
};

/// One recursion of the filter: predict, likelihoodTable, associate, update, each distinct track
/// once (method.md 5). A pure function: equal arguments give equal results for any number of
/// threads. Precondition: the scan is not older than the tracks. `key` selects the random streams;
/// its counter is the index of the scan. Number of hypotheses returned: as many slots as before
/// (sampled), at most `slots` (ranked), one (nearest). Weights are exact posterior weights up to
/// the hypotheses that were pruned.
StepResult step(const Posterior& before, const MeasurementScan& scan, const FilterModel& model,
                const RngKey& key, std::size_t slots);

/// The hypothesis of largest weight after the weights of slots of equal history are summed
/// (method.md 5.11).
struct MapHypothesis {
  std::size_t slot = 0;      ///< index of the first slot that holds it
  double probability = 0;    ///< sum of the weights of these slots
  std::size_t distinct = 0;  ///< number of distinct hypotheses
};
MapHypothesis mapHypothesis(const Posterior& posterior);

}  // namespace perception
