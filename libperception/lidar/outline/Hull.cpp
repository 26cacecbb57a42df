#include "libperception/lidar/outline/Hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace perception {
namespace {

double cross(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Removes points that cannot be on the hull: those strictly inside the octagon of eight extreme
/// points.
void dropInner(std::vector<Vector2>& points) {
  // Along x, x + y, y, y - x, and against them.
  std::array<Vector2, 8> corner;
  std::array<double, 4> most, least;
  most.fill(-std::numeric_limits<double>::infinity());
  least.fill(std::numeric_limits<double>::infinity());
  for (const Vector2& p : points) {
    const double along[] = {p.x(), p.x() + p.y(), p.y(), p.y() - p.x()};
    for (std::size_t k = 0; k < 4; ++k) {
      if (along[k] > most[k]) most[k] = along[k], corner[k] = p;
      if (along[k] < least[k]) least[k] = along[k], corner[k + 4] = p;
    }
  }
  struct Side {
    Vector2 from, along;
  };
  std::array<Side, 8> sides;
  std::size_t count = 0;
  for (std::size_t k = 0; k < 8; ++k)
    if (const Vector2& a = corner[k], &b = corner[(k + 1) % 8]; a != b) sides[count++] = {a, b - a};
  const auto inside = [&](const Vector2& p) {
    return std::all_of(sides.begin(), sides.begin() + static_cast<std::ptrdiff_t>(count),
                       [&](const Side& s) { return !(cross(s.along, p - s.from) <= 0); });
  };
  points.erase(std::remove_if(points.begin(), points.end(), inside), points.end());
}

}  // namespace

Rectangle rectangleAlong(const std::vector<Vector2>& points, double yaw) {
  const double c = std::cos(yaw), s = std::sin(yaw);
  Rectangle r{yaw, 1e30, -1e30, 1e30, -1e30};
  for (const Vector2& p : points) {
    const double a = c * p.x() + s * p.y(), b = c * p.y() - s * p.x();
    r.a0 = std::min(r.a0, a), r.a1 = std::max(r.a1, a), r.b0 = std::min(r.b0, b),
    r.b1 = std::max(r.b1, b);
  }
  return r;
}

std::vector<Vector2> convexHull(std::vector<Vector2> points) {
  if (points.size() > 32) dropInner(points);
  std::sort(points.begin(), points.end(), [](const Vector2& a, const Vector2& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  const std::size_t count = points.size();
  if (count < 3) return points;
  // Andrew's monotone chain: the lower half left to right, the upper half right to left.
  std::vector<Vector2> hull;
  hull.reserve(2 * count);
  const auto append = [&hull](const Vector2& p, std::size_t floor) {
    while (hull.size() > floor && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0)
      hull.pop_back();
    hull.push_back(p);
  };
  for (std::size_t i = 0; i < count; ++i) append(points[i], 1);
  const std::size_t lower = hull.size();
  for (std::size_t i = count - 1; i-- > 0;) append(points[i], lower);
  hull.pop_back();
  return hull;
}

double distanceToHull(const std::vector<Vector2>& hull, const Vector2& place) {
  if (hull.empty()) return std::numeric_limits<double>::infinity();
  double nearest2 = std::numeric_limits<double>::infinity();
  bool inside = hull.size() > 2;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vector2& a = hull[i];
    const Vector2 side = hull[(i + 1) % hull.size()] - a, d = place - a;
    const double length2 = side.squaredNorm();
    const double along = length2 > 0 ? std::clamp(d.dot(side) / length2, 0.0, 1.0) : 0;
    nearest2 = std::min(nearest2, (d - along * side).squaredNorm());
    inside = inside && cross(side, d) >= 0;
  }
  return inside ? 0 : std::sqrt(nearest2);
}

HullSize sizeOf(const std::vector<Vector2>& hull) {
  HullSize size;
  if (hull.size() < 2) return size;
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < hull.size();
       ++i) {  // the smallest rectangle is collinear with a side of the hull
    const Vector2 side = hull[(i + 1) % hull.size()] - hull[i];
    const Rectangle r = rectangleAlong(hull, std::atan2(side.y(), side.x()));
    const double area = (r.a1 - r.a0) * (r.b1 - r.b0);
    if (area < smallest) smallest = area, size = {std::max(r.a1 - r.a0, r.b1 - r.b0), area};
  }
  return size;
}

}  // namespace perception
