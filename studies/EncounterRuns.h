#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/simulation/EncounterScenes.h"

namespace perception {

/// The filter on one simulated encounter.
struct EncounterScore {
  bool swapped = false;    ///< some object's dominant id differs before and after the encounter
  double gospa = 0;        ///< [m] root of the mean square over instants, cut-off 2 m
  double tracked = 0;      ///< share of (object, instant) with an estimate within 2 m
  std::vector<int> count;  ///< objects output in view, by instant
  std::vector<int> classified;   ///< of these, with a class of 95 % or more
  std::vector<int> truth_count;  ///< objects in view, by instant
};

/// Runs the filter on scene `name` under `conditions`: truth and measurements are a function of
/// `seed`, the filter's own draws of `filter_seed`. The first second is warm-up for `tracked` and
/// `swapped`; an id is dominant before in the first third, after in the last four tenths.
EncounterScore runEncounter(const std::string& name, const EncounterConditions& conditions,
                            const FilterModel& model, int particles, std::uint64_t seed,
                            std::uint64_t filter_seed);

/// Wilson's upper bound of a rate, 95 % two-sided.
double wilsonUpper(int events, int trials);

}  // namespace perception
