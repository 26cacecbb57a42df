#include "libperception/interop/exports/Jpeg.h"

#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <vector>

namespace perception {

std::string jpegOf(const Raster& raster) {
  std::vector<std::uint8_t> pixels = raster.pixels, bytes;
  const cv::Mat image(raster.height, raster.width, CV_8UC(raster.channels), pixels.data());
  cv::imencode(".jpg", image, bytes);
  return {bytes.begin(), bytes.end()};
}

}  // namespace perception
