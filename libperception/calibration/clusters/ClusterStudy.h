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

/// The same model with the shapes that the recordings among `logs` show. Throws DataError where it
/// has not learned from one of them, since what stands there is no more known for that.
StudyReport knownShapesStudy(const ClusterSamples& samples, const std::vector<TrainingLog>& logs,
                             const ClusterClassifier& model);

}  // namespace perception
