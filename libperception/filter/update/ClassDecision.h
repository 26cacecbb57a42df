#pragma once
#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"

namespace perception {

/// Decides the class whose probability reaches [filter] decide_class, or revokes the decision when
/// it falls below or a measurement `surprised` the decided class's filter (beyond its gate).
void decideClass(const FilterModel& model, bool surprised, Track& track);

}  // namespace perception
