#pragma once
#include <optional>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"

namespace perception {

/// What is seen of an object's height, length and width, as an estimate that knows of no class
/// (Track::height, length, width), and what it says of the class: the density of the estimate over
/// the class's objects. Whenever an estimate changes, the evidence of the one before is taken back,
/// so that in the end a size counts once, however often it was seen.

/// The estimates of a newborn: the mixture of all classes.
void startSizes(const FilterModel& model, Track& track);

/// After a measurement: heights, complete sides along `axis` [rad] (the length axis; empty: not
/// known, sides say nothing), and their evidence in track.log_class (not normalized).
void updateSizes(const Measurement& m, std::optional<double> axis, const FilterModel& model,
                 Track& track);

}  // namespace perception
