#pragma once
#include <optional>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"

namespace perception {

/// The track at time `at` given all measurements until `now` (fixed-lag smoothing, method.md 5.17):
/// Rauch-Tung-Striebel recursion of each class filter and backward recursions of existence and
/// class chain along Track::previous (FilterModel::history). Exact for linear models of one mode;
/// motion modes enter by the moments of their mixture, static sizes by their current estimates.
/// Empty before the birth of the track. Where the history is shorter, the oldest state.
std::optional<Track> smoothedTrack(const Track& now, Stamp at, const FilterModel& model);

}  // namespace perception
