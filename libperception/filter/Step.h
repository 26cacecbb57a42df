#pragma once
#include "libperception/core/Random.h"
#include "libperception/filter/Association.h"
#include "libperception/filter/FilterModel.h"
#include "libperception/filter/Track.h"

namespace perception {

/// Numbers of one step, for reports.
struct StepStats {
  std::size_t hypotheses = 0;       ///< distinct ones after the step
  std::size_t distinct_tracks = 0;  ///< predicted and scored once each
  std::size_t pairs = 0;            ///< track-measurement pairs inside the gate
  std::size_t measurements = 0;
  std::size_t updates = 0;  ///< distinct (track, measurement) updates
};

/// The hypotheses after a scan, slot by slot, and what to add to their log weights.
struct StepResult {
  std::vector<Hypothesis> hypotheses;
  std::vector<double> log_weights;  ///< increments: log p(scan | history) / proposal
  StepStats stats;
};

/// The whole filter for one scan: predict, likelihoodTable, associate, update, each distinct track
/// once. A pure function: equal arguments give equal results for any number of threads. The scan
/// must not be older than the tracks. `key` names the random streams; its counter is the index of
/// the scan.
StepResult step(const std::vector<Hypothesis>& hypotheses, const MeasurementScan& scan,
                const FilterModel& model, const RngKey& key);

/// The hypothesis of largest weight after slots of equal history are added up (SPEC 5.11). Weights
/// need no norm.
struct MapHypothesis {
  std::size_t slot = 0;      ///< of its first copy
  double probability = 0;    ///< summed weight of its copies
  std::size_t distinct = 0;  ///< number of distinct hypotheses
};
MapHypothesis mapHypothesis(const std::vector<const Hypothesis*>& hypotheses,
                            const std::vector<double>& log_weights);

}  // namespace perception
