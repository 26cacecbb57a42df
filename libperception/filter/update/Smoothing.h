#pragma once
#include <optional>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"

namespace perception {

/// The track as it was at the time `at`, given all that was seen until now (fixed-lag smoothing,
/// method.md 5.17): the recursion of Rauch, Tung and Striebel for each class filter, the backward
/// recursions of two-state existence and of the class chain, back along what the track is linked to
/// (FilterModel::history). Exact for linear classes of one mode; motion modes count with their
/// common mean and spread, and sizes, which do not change, are today's. Empty when the track was
/// not born yet. Where the history ends early it is the oldest state that there is.
std::optional<Track> smoothedTrack(const Track& now, Stamp at, const FilterModel& model);

}  // namespace perception
