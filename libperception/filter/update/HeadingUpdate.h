#pragma once
#include <optional>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/MeasurementModel.h"

namespace perception {

/// What a detector says of the heading (method.md 7): the axis by a scalar update, the direction by
/// the bit. With `may_mirror` an axis that the detector denies again and again is taken from it
/// anew: the edges of an image box fit two headings that mirror each other, and a Gaussian in the
/// wrong one of them stays there. A box in space has no such second fit.
void useHeading(const MeasuredHeading& seen, const FilterParams& params, ClassFilter& f,
                bool may_mirror = true);

/// A wheeled filter takes its heading from what is known by now: the detector, the box seen
/// (`birth`), else its own motion (method.md 3.4, with a constant-velocity start in place of the
/// two-point start). An oriented one that drives backwards against what is known of its direction
/// is reversed.
void findHeading(const Measurement& m, const std::optional<BirthState>& birth,
                 const FilterParams& params, ClassFilter& f);

/// Where an object without a heading in its state looks: axis by a scalar filter, direction by the
/// bit, as useHeading() for the others.
void updateBodyHeading(const MeasuredHeading& seen, const FilterParams& params, Track& track);

}  // namespace perception
