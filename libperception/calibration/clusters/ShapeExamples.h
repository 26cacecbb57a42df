#pragma once
#include <vector>

#include "libperception/calibration/clusters/ClusterSamples.h"
#include "libperception/lidar/classification/KnownShapes.h"

namespace perception {

/// Examples of the kinds of road users for KnownShapes, from the samples of each of the recordings
/// `of_log` (indices), thinned to those that differ. How far a known shape may be from them is the
/// median over the recordings of how far nine tenths of a recording's samples are from the examples
/// of the others. A kind that fewer than three recordings show five times is not stored.
KnownShapes shapeExamples(const ClusterSamples& samples,
                          const std::vector<std::vector<std::size_t>>& of_log);

}  // namespace perception
