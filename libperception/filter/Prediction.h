#pragma once
#include "libperception/filter/FilterModel.h"
#include "libperception/filter/Track.h"

namespace perception {

/// Pass 1: the track at a later time: every class filter, existence, class chain, base height
/// (SPEC 5.1, 5.7).
Track predictTrack(const Track& track, Stamp to, const FilterModel& model);

}  // namespace perception
