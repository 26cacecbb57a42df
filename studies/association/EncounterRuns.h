#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/simulation/world/EncounterScenes.h"

namespace perception {

/// Results of the filter on one simulated encounter.
struct EncounterScore {
  bool swapped = false;  ///< the dominant id of some object differs before and after the encounter
  double gospa = 0;      ///< [m] root of the mean square over instants, cut-off 2 m
  double tracked = 0;    ///< share of (object, instant) with an estimate within 2 m
  std::vector<int> count;        ///< objects output in view, by instant
  std::vector<int> classified;   ///< of these, with a class probability >= .95
  std::vector<int> truth_count;  ///< objects in view, by instant
};

/// The filter of the encounters: two motion modes of pedestrians, no pruning except the gate.
FilterModel encounterModel(Proposal proposal);

/// Runs the filter on scene `name` under `conditions`: `seed` determines truth and measurements,
/// `filter_seed` the filter's samples. `tracked` and `swapped` exclude the first second; before is
/// the first third of the scene, after the last four tenths.
EncounterScore runEncounter(const std::string& name, const EncounterConditions& conditions,
                            const FilterModel& model, int particles, std::uint64_t seed,
                            std::uint64_t filter_seed);

}  // namespace perception
