#pragma once
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Embeds a spherical image of any size (the full circle in azimuth, possibly not in elevation)
/// into the whole panorama that tiles are taken from (width = 2 height, a multiple of 8). Missing
/// rows replicate the first or last one.
class PanoramaFit {
 public:
  /// `camera` equirectangular; fx, fy = width / 2 pi.
  explicit PanoramaFit(const CameraModel& camera);

  int width() const { return width_; }     ///< [px] of the whole panorama
  bool isWhole() const { return whole_; }  ///< the image is a whole panorama already
  Raster whole(const Raster& image) const;
  /// Converts boxes of the whole panorama to pixels of the image. A lower edge below its last row
  /// is truncated.
  void toPicture(std::vector<ObjectDetection>& objects) const;

 private:
  CameraModel camera_;
  int width_ = 0, top_ = 0;  ///< [px]; `top_`: rows above the image's first
  double scale_ = 1;         ///< pixels of the whole panorama per pixel of the image
  bool whole_ = false;
};

}  // namespace perception
