#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/detectors/DetectionQuality.h"
#include "libperception/detectors/Detector.h"

namespace perception {

/// A line of KITTI's result files: image box, alpha and score; the rest unknown.
std::string kittiBoxLine(const ObjectDetection& object);
/// quality.csv: a line a label.
std::string qualityCsv(const std::vector<LabelQuality>& quality);
/// precision.csv: the curves, a line a score.
std::string precisionCsv(const std::vector<LabelQuality>& quality);
/// The models' logistics, P(right | score), as an INI to be included by that of the detector.
std::string calibrationIni(const DetectorSetup& setup, const DetectionQuality& quality,
                           std::int64_t images, double overlap);

}  // namespace perception
