#pragma once
#include "libperception/measurement/SensorFrame.h"

namespace cv {
class Mat;
}

namespace perception {

/// The pixels as blue, green, red; shares them when they are so already.
cv::Mat colorMat(const Raster& image);

}  // namespace perception
