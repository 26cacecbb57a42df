#pragma once
#include "libperception/filter/likelihood/LikelihoodTable.h"
#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"

namespace perception {

// [radecki2016]'s assignment probability that is not uniform (its p(a | Z, A)): what earlier
// assignments tell of a measurement beside the state. Two parts, each a normalized density over
// values that track, birth and clutter are all weighed by, so that the weights of hypotheses stay
// exact.

/// [filter] shape_prior: log density of the measurement's height and lowest point [m], given that
/// this track caused it. 0 where the measurement has neither.
double logShape(const Track& track, const Measurement& m);
/// The same for a newborn of class c.
double logShape(const ObjectClass& c, const Measurement& m, const SensorState& sensor);
/// Multiplies birth and clutter densities by theirs. Call before the two are normalized against
/// each other.
void weighShape(const Measurement& m, const SensorState& sensor, const FilterModel& model,
                BirthLikelihood& births);

/// [filter] region_memory: residual of the track's last update by the scan's sensor; null when
/// there is none or region_memory = 0.
const RegionSeen* regionOf(const Track& track, const MeasurementScan& scan,
                           const FilterModel& model);
/// The innovation under AR(1) measurement errors with correlation rho, given the last residual e: y
/// - rho e with noise (1 - rho^2) R on the same axes. Axes that were not seen in the last update
/// are unchanged.
Innovation withRegion(Innovation innovation, const RegionSeen& region, const Measurement& m,
                      const MeasurementScan& scan, const FilterModel& model);
/// Stores the residual of a track that was just updated with this measurement.
void rememberRegion(const Measurement& m, const MeasurementScan& scan, const FilterModel& model,
                    Track& track);

}  // namespace perception
