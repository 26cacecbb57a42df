#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/scene/Scene.h"
#include "libperception/simulation/world/EncounterScenes.h"

namespace perception {

/// Results of the filter on one simulated encounter.
struct EncounterScore {
  double gospa = 0;              ///< [m] root of the mean square over instants, cut-off 2 m
  std::vector<int> count;        ///< objects output in view, by instant
  std::vector<int> classified;   ///< of these, with a class probability >= .95
  std::vector<int> truth_count;  ///< objects in view, by instant
};

/// The filter of the encounters: two motion modes of pedestrians, no pruning except the gate.
FilterModel encounterModel(Proposal proposal);

/// Runs the filter on a scene under `conditions`: `seed` determines the measurements, `filter_seed`
/// the filter's samples. `see` is called with each instant and what the filter makes of it.
EncounterScore runEncounter(const EncounterScene& scene, const EncounterConditions& conditions,
                            const FilterModel& model, int particles, std::uint64_t seed,
                            std::uint64_t filter_seed,
                            const std::function<void(std::size_t, const Scene&)>& see = {});

}  // namespace perception
