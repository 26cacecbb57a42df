#pragma once
#include <string>
#include <vector>

namespace perception {

/// A row of [radecki2016]'s table of panorama resolutions (method.md 4.2). Its recall and precision
/// hold within the ranges.
struct CameraResolution {
  const char* name;
  int width, height;               ///< [px] of the whole sphere
  double car_range, person_range;  ///< [m]
  /// Expected false boxes per image: detections per image of [radecki2016] (cars
  /// .46/1.53/4.52/8.12, persons .15/.45/5.98/27.31) times 1 - precision (95 and 90 %).
  double false_per_image;
};

/// 1k, 2k, 4k, 8k.
const std::vector<CameraResolution>& cameraResolutions();
std::vector<std::string> cameraResolutionNames();

}  // namespace perception
