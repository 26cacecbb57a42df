#pragma once
#include "libperception/filter/likelihood/LikelihoodTable.h"
#include "libperception/filter/state/FilterModel.h"

namespace perception {

/// Pass 4 (method.md 5.5): updates the predicted track with the pair's measurement: class filters,
/// class posterior, extent, height; existence goes to existence_max. `scan_index` counts scans and
/// is hashed into the history.
Track hitTrack(Track predicted, const TrackLikelihoods& row, const PairLikelihood& pair,
               const MeasurementScan& scan, std::uint64_t scan_index, const FilterModel& model);

/// Missed detection: lowers the existence probability and the probabilities of classes with high
/// P_D.
Track missTrack(Track predicted, const TrackLikelihoods& row, const MeasurementScan& scan,
                const FilterModel& model);

/// The Bernoulli newborn of a measurement.
Track newTrack(const BirthLikelihood& births, std::size_t measurement, const MeasurementScan& scan,
               std::uint64_t scan_index, const FilterModel& model);

}  // namespace perception
