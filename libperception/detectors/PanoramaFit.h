#pragma once
#include <vector>

#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// How a spherical picture of any size, the full circle across but perhaps not from pole to pole,
/// lies in the whole panorama that tiles are cut from (width = 2 height, a multiple of 8). Rows
/// that the picture does not have repeat its first or last one.
class PanoramaFit {
 public:
  /// `camera` equirectangular; fx, fy = width / 2 pi.
  explicit PanoramaFit(const CameraModel& camera);

  int width() const { return width_; }     ///< [px] of the whole panorama
  bool isWhole() const { return whole_; }  ///< the picture is one itself
  Raster whole(const Raster& image) const;
  /// Boxes of the whole panorama in pixels of the picture. A foot below its last row is cut off by
  /// it.
  void toPicture(std::vector<ObjectDetection>& objects) const;

 private:
  CameraModel camera_;
  int width_ = 0, top_ = 0;  ///< [px]; rows above the picture's first
  double scale_ = 1;         ///< whole panorama's pixels in one of the picture's
  bool whole_ = false;
};

}  // namespace perception
