#pragma once
#include "libperception/filter/likelihood/LikelihoodTable.h"
#include "libperception/filter/state/FilterModel.h"

namespace perception {

/// Pass 4 (method.md 5.5). The predicted track after it caused the pair's measurement: every class
/// filter, class posterior, extent, heights; existence becomes certain. `scan_index` counts scans
/// and goes into the history.
Track hitTrack(Track predicted, const TrackLikelihoods& row, const PairLikelihood& pair,
               const MeasurementScan& scan, std::uint64_t scan_index, const FilterModel& model);

/// The predicted track after a scan without a measurement of it: existence and the classes that
/// should have been seen lose mass.
Track missTrack(Track predicted, const TrackLikelihoods& row, const MeasurementScan& scan,
                const FilterModel& model);

/// The Bernoulli newborn of a measurement.
Track newTrack(const BirthLikelihood& births, std::size_t measurement, const MeasurementScan& scan,
               std::uint64_t scan_index, const FilterModel& model);

}  // namespace perception
