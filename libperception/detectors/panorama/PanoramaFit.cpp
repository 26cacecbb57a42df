#include "libperception/detectors/panorama/PanoramaFit.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "libperception/detectors/panorama/Panorama.h"

namespace perception {

PanoramaFit::PanoramaFit(const CameraModel& camera)
    : camera_(camera),
      width_((camera.width + Panorama::kTiles - 1) / Panorama::kTiles * Panorama::kTiles) {
  scale_ = static_cast<double>(width_) / std::max(1, camera.width);
  // The horizon is the middle row of the whole panorama.
  top_ = static_cast<int>(std::lround(0.25 * width_ - scale_ * (camera.cy + 0.5)));
  whole_ = width_ == camera.width && 2 * camera.height == width_ && top_ == 0;
}

Raster PanoramaFit::whole(const Raster& image) const {
  if (image.width != camera_.width || image.height != camera_.height) return {};
  const cv::Mat pixels(image.height, image.width, CV_8UC(image.channels),
                       const_cast<std::uint8_t*>(image.pixels.data()));
  const int rows = static_cast<int>(std::lround(scale_ * image.height));
  cv::Mat scaled;
  cv::resize(pixels, scaled, {width_, rows}, 0, 0, cv::INTER_LINEAR);
  // Rows beyond a pole are dropped.
  const int first = std::max(0, -top_), last = std::min(rows, width_ / 2 - top_);
  Raster out{width_, width_ / 2, image.channels, {}};
  if (first >= last) return {};
  cv::Mat whole;
  cv::copyMakeBorder(scaled.rowRange(first, last), whole, std::max(0, top_),
                     width_ / 2 - std::max(0, top_) - (last - first), 0, 0, cv::BORDER_REPLICATE);
  out.pixels.assign(whole.datastart, whole.dataend);
  return out;
}

void PanoramaFit::toPicture(std::vector<ObjectDetection>& objects) const {
  const double last = camera_.height;
  for (ObjectDetection& o : objects) {
    if (!o.image_box) continue;
    auto& b = *o.image_box;
    // Pixel centers have integer coordinates.
    const auto column = [&](double u) { return (u + 0.5) / scale_ - 0.5; };
    const auto row = [&](double v) {
      return std::clamp((v + 0.5 - top_) / scale_ - 0.5, -0.5, last);
    };
    b = {column(b.x1), row(b.y1), column(b.x2), row(b.y2)};
    if (b.y2 >= last - 0.5) b.y2 = last;
  }
  objects.erase(std::remove_if(objects.begin(), objects.end(),
                               [](const ObjectDetection& o) {
                                 return o.image_box && o.image_box->y2 - o.image_box->y1 < 1;
                               }),
                objects.end());
}

}  // namespace perception
