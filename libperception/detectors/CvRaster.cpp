#include "libperception/detectors/CvRaster.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace perception {

cv::Mat colorMat(const Raster& image) {
  const cv::Mat pixels(image.height, image.width, CV_8UC(image.channels),
                       const_cast<std::uint8_t*>(image.pixels.data()));
  if (image.channels == 3) return pixels;
  cv::Mat color;
  cv::cvtColor(pixels, color, image.channels == 4 ? cv::COLOR_BGRA2BGR : cv::COLOR_GRAY2BGR);
  return color;
}

}  // namespace perception
