#pragma once
#include <vector>

#include "libperception/calibration/clusters/ClusterSamples.h"
#include "libperception/lidar/classification/KnownShapes.h"

namespace perception {

/// Examples of the kinds of road users for KnownShapes, from the samples of each of the recordings
/// `of_log` (indices), thinned to those that differ. A known shape may be as far from them as nine
/// tenths of the samples of every recording but one are from the examples of the others. A kind
/// that fewer than three recordings show five times is not stored.
KnownShapes shapeExamples(const ClusterSamples& samples,
                          const std::vector<std::vector<std::size_t>>& of_log);

}  // namespace perception
