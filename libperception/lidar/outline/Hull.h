#pragma once
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// Convex hull, counter-clockwise from the leftmost lowest point, without points on its sides.
std::vector<Vector2> convexHull(std::vector<Vector2> points);

/// Distance [m] from point `place` to the hull (a polygon, a segment or a point); 0 inside.
double distanceToHull(const std::vector<Vector2>& hull, const Vector2& place);

/// Longest side [m] of the smallest enclosing rectangle and its area [m^2].
struct HullSize {
  double longest = 0, area = 0;
};
HullSize sizeOf(const std::vector<Vector2>& hull);

/// Enclosing rectangle with sides along and across `yaw` [rad]: its bounds [m] along (a) and across
/// (b).
struct Rectangle {
  double yaw, a0, a1, b0, b1;
};
Rectangle rectangleAlong(const std::vector<Vector2>& points, double yaw);

}  // namespace perception
