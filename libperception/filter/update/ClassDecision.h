#pragma once
#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"

namespace perception {

/// Decides a class that has become sure, or takes the decision back; a measurement that `surprised`
/// the decided class makes it unsure.
void decideClass(const FilterModel& model, bool surprised, Track& track);

}  // namespace perception
