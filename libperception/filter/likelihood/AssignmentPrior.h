#pragma once
#include "libperception/filter/likelihood/LikelihoodTable.h"
#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"

namespace perception {

// [radecki2016]'s assignment probability that is not uniform (its p(a | Z, A)): what earlier
// assignments tell of a measurement beside the state. Two parts, each a normalized density over
// values that track, birth and clutter are all weighed by, so that the weights of hypotheses stay
// exact.

/// [filter] shape_prior: log density of the measurement's height and lowest point, given that it is
/// of this track. 0 where it has neither.
double logShape(const Track& track, const Measurement& m);
/// The same of a newborn of class c.
double logShape(const ObjectClass& c, const Measurement& m, const SensorState& sensor);
/// Weighs birth and clutter by it; before they are compared.
void weighShape(const Measurement& m, const SensorState& sensor, const FilterModel& model,
                BirthLikelihood& births);

/// [filter] region_memory: the track's last region seen by the scan's sensor; null: none, or not
/// asked for.
const RegionSeen* regionOf(const Track& track, const MeasurementScan& scan,
                           const FilterModel& model);
/// The innovation, given that the last region's error goes on with correlation rho: y - rho e with
/// the noise (1 - rho^2) R, a Gaussian over the same axes. Axes that were not seen then stay.
Innovation withRegion(Innovation innovation, const RegionSeen& region, const Measurement& m,
                      const MeasurementScan& scan, const FilterModel& model);
/// Keeps the region of a track that was just updated by this measurement.
void rememberRegion(const Measurement& m, const MeasurementScan& scan, const FilterModel& model,
                    Track& track);

}  // namespace perception
