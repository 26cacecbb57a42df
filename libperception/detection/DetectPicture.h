#pragma once
#include <vector>

#include "gui-offscreen/drawing/Picture.h"
#include "libperception/detectors/DetectionQuality.h"

namespace perception {

/// The image with the detector's boxes, labels and scores, an arrow for each heading, and the truth
/// as dashed boxes. `calibrated`: scores are log-odds.
Picture detectionPicture(const Raster& image, const std::vector<ObjectDetection>& objects,
                         const std::vector<LabeledBox>& truth, bool calibrated);

}  // namespace perception
