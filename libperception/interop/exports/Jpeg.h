#pragma once
#include <string>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// The picture as the bytes of a JPEG file, in OpenCV's quality.
std::string jpegOf(const Raster& raster);

}  // namespace perception
