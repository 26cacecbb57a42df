#pragma once
#include "libperception/core/Random.h"
#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"

namespace perception {

/// Numbers of one step, for reports.
struct StepStats {
  std::size_t hypotheses = 0;       ///< distinct ones after the step
  std::size_t distinct_tracks = 0;  ///< of the hypotheses before it
  std::size_t predicted = 0;        ///< of those, moved to the scan's time and scored, once each
  std::size_t pairs = 0;            ///< track-measurement pairs inside the gate
  std::size_t measurements = 0;
  std::size_t updates = 0;  ///< distinct updated tracks that were made
};

/// The posterior: weighted hypotheses. With the sampled proposal slots of equal history share a
/// handle; with the ranked one every handle is another history.
struct Posterior {
  std::vector<HypothesisHandle> hypotheses;
  std::vector<double> log_weights;  ///< need no norm

  /// `n` empty hypotheses of equal weight.
  static Posterior empty(std::size_t n);
};

struct StepResult {
  Posterior posterior;
  StepStats stats;
};

/// The whole filter for one scan: predict, likelihoodTable, associate, update, each distinct track
/// once. A pure function: equal arguments give equal results for any number of threads. The scan
/// must not be older than the tracks. `key` names the random streams; its counter is the index of
/// the scan.
/// Sampled: slot by slot, as many as before. Ranked: the likeliest hypotheses, at most `slots`;
/// nearest: the likeliest alone. Their weights are exact: what is missing of the evidence is the
/// weight of the hypotheses that were dropped.
StepResult step(const Posterior& before, const MeasurementScan& scan, const FilterModel& model,
                const RngKey& key, std::size_t slots);

/// The hypothesis of largest weight after slots of equal history are added up (method.md 5.11).
struct MapHypothesis {
  std::size_t slot = 0;      ///< of its first copy
  double probability = 0;    ///< summed weight of its copies
  std::size_t distinct = 0;  ///< number of distinct hypotheses
};
MapHypothesis mapHypothesis(const Posterior& posterior);

}  // namespace perception
