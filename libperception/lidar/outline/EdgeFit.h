#pragma once
#include "libperception/lidar/outline/PointFours.h"

namespace perception {

/// The direction, in steps of 3 deg, in which most points lie close to the sides of the rectangle
/// about them.
struct EdgeFit {
  float along_x = 1, along_y = 0;  ///< unit vector along the longer side
  float distance = 0;              ///< [m] sum of the distances to the nearest side
  float close = 0;                 ///< number of points within 12 cm of it
};

/// Of at most 4 TurnedPoints::kMost points.
EdgeFit fitEdges(const PointFours& points);

}  // namespace perception
