#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/detectors/DetectionQuality.h"
#include "libperception/detectors/Detector.h"

namespace perception {

/// A line of KITTI's result files: image box, alpha and score; other columns unknown.
std::string kittiBoxLine(const ObjectDetection& object);
/// One line per label that was found in the truth, for people.
std::string qualityText(const std::vector<LabelQuality>& quality);
/// quality.csv: one line per label.
std::string qualityCsv(const std::vector<LabelQuality>& quality);
/// precision.csv: precision-recall curves, one line per score.
std::string precisionCsv(const std::vector<LabelQuality>& quality);
/// The fitted logistic functions P(correct | score) as an INI to be included by that of the
/// detector.
std::string calibrationIni(const DetectorSetup& setup, const DetectionQuality& quality,
                           std::int64_t images, double overlap);

}  // namespace perception
