#pragma once
#include <vector>

#include "libperception/calibration/clusters/ClusterTraining.h"
#include "libperception/lidar/classification/KnownShapes.h"

namespace perception {

/// Examples of the kinds of road users for KnownShapes, from the samples of all recordings among
/// `logs` but `without` (logs.size(): of all), thinned to those that differ. A known shape may be
/// as far from them as nine tenths of the samples of every recording but one are from the examples
/// of the others. A kind that fewer than three recordings show five times is not stored.
KnownShapes shapeExamples(const ClusterSamples& samples, const std::vector<TrainingLog>& logs,
                          std::size_t without);

}  // namespace perception
