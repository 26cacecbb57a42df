#pragma once
#include <cstdint>
#include <vector>

#include "libperception/calibration/clusters/ClusterTraining.h"
#include "libperception/evaluation/tables/StudyReport.h"

namespace perception {

/// Learns a classifier of lidar clusters from all logs, and how good it is on each log that it has
/// not seen: tables left_out (clusters), boxes (objects by their cluster) and reliability, and the
/// file lidar_classes.json. Throws DataError where fewer than three logs
/// have clusters of a known kind. With `model_only` the file alone, in a fraction of the time.
StudyReport clusterStudy(const ClusterSamples& samples, const std::vector<TrainingLog>& logs,
                         const Provenance& provenance, std::uint64_t seed, bool model_only = false);

}  // namespace perception
