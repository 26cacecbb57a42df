#pragma once
#include <functional>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/lidar/classification/ClusterClassifier.h"
#include "libperception/lidar/description/DescribedClusters.h"

namespace perception {

/// The clusters of a scan that may be road users, and what is known of its obstacles besides.
struct Judgement {
  std::vector<JudgedCluster> clusters;
  std::vector<float> phantom;  ///< of each obstacle, see PlacedReturns::phantom
  ClusterVerdicts verdicts;
};

/// The causes of phantoms at a place [m, ego frame]; empty: none anywhere.
using CausesAt = std::function<CausesHere(const Vector2&)>;

/// Clusters (method.md 8.10): a segment, or its parts where one of them is likelier a road user
/// than the whole; without those that are surely a thing or a phantom and without those in the
/// footprint of a likely vehicle. `cells`: of the scan's points. Whatever is farther from the
/// sensor than `reach` [m] counts as a thing.
Judgement judgedClusters(const LidarDetections& found, const LidarCloud& cloud,
                         const DirectionCells& cells, const ClusterClassifier& classifier,
                         const CausesAt& causes_at = {}, double reach = 1e9);

}  // namespace perception
