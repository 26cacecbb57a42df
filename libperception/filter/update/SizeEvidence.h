#pragma once
#include <optional>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"

namespace perception {

/// Size as evidence of the class (method.md 5.14). Height, length and width are estimated without a
/// class prior (Track::height, length, width); the class likelihood is the density of the estimate
/// over the sizes of the class. When an estimate changes, its former likelihood is divided out, so
/// that each size counts once. Of clusters that are told by their shape, classes of one shape are
/// told apart by the sides as they fit best along or across the heading, and by the longest one.

/// Initial estimates of a newborn: moments of the mixture of all classes.
void startSizes(const FilterModel& model, Track& track);

/// Updates height, and length and width from complete sides, and adds their log likelihood to
/// track.log_class (not normalized). `axis` [rad]: the length axis; empty: unknown, sides are not
/// used.
void updateSizes(const Measurement& m, std::optional<double> axis, const FilterModel& model,
                 Track& track);

}  // namespace perception
