#pragma once
#include "libperception/measurement/frames/SensorFrame.h"

namespace cv {
class Mat;
}

namespace perception {

/// The image as blue, green, red; shares the pixels of an image in this format.
cv::Mat colorMat(const Raster& image);

}  // namespace perception
