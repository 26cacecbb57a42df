#pragma once
#include <optional>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Frames.h"
#include "libperception/lidar/outline/Hull.h"
#include "libperception/measurement/Measurement.h"

namespace perception {

/// Parameters of the box fit to clusters (method.md 8.6).
struct BoxParams {
  double step = radians(2);      ///< [rad] of the search over 90 degrees (method.md 8.6)
  double min_distance = 0.05;    ///< [m] d0 of the closeness criterion (assumed; [zhang2017]: 0.01)
  int max_points = 400;          ///< of a cluster used in the search, evenly subsampled (assumed)
  double outlier_share = 0.015;  ///< of the returns at each end, left out when ... (assumed)
  double outlier_gap = 0.25;     ///< [m] ... this gap separates them from the rest (assumed)
  double corner_sigma = 0.20;    ///< [m] of a side's end (tuned on KITTI 0000)
  double yaw_sigma_min = radians(3);  ///< [rad] least deviation of yaw (method.md 8.6)
  double grazing = radians(15);       ///< [rad] least angle of a side of reliable length (assumed)
};

/// L-shape fit by the closeness criterion [zhang2017]. Side a is the longer one; yaw is that of an
/// axis, in (-pi/2, pi/2]. `left_open`, `right_open`: the outline's left and right edge as seen
/// from `sensor` is not occluded. Points, sensor and result are in one frame [m]. Empty for fewer
/// than two distinct points.
std::optional<PartialBox> fitBox(const std::vector<Vector2>& points, const Vector2& sensor,
                                 bool left_open, bool right_open, const BoxParams& params);

}  // namespace perception
