#pragma once
#include "libperception/filter/FilterModel.h"
#include "libperception/filter/Track.h"

namespace perception {

/// Takes tracks out of a hypothesis that stand inside another track's footprint: two solid objects
/// cannot (SPEC 5.9 asks for an overlap of half of both; a fragment of a vehicle is smaller than
/// that). Only footprints larger than `merge_area` swallow others, so people in a crowd stay apart.
/// The older track keeps its identity; when it has not been seen lately and the younger one has, it
/// takes over the younger one's state. `merge_area` = 0: nothing is merged.
void mergeDuplicates(const FilterModel& model, Stamp now, Hypothesis& hypothesis);

}  // namespace perception
