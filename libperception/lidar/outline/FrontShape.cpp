#include "libperception/lidar/outline/FrontShape.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace perception {
namespace {

constexpr std::size_t kCells = 10;         // along the side (assumed)
constexpr std::size_t kLeastTops = 8;      // with a top edge (assumed)
constexpr std::size_t kLeastInCell = 3;    // returns that show the top edge of a cell (assumed)
constexpr std::size_t kLeastReturns = 60;  // (assumed)
constexpr double kShortest = 3.5, kLongest = 6;  // [m] of cars; less: a part is hidden (assumed)
constexpr double kHighest = 2.3;  // [m] of cars and vans; cabs of trucks are higher (assumed)
constexpr double kPerFall = 8;    // [1/m] fitted, method.md 8.6
constexpr double kMost = 3.5;     // fitted, method.md 8.6

/// That value of which the share `share` is below.
double quantile(std::vector<double>& values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

}  // namespace

double frontLogOdds(const std::vector<Vector2>& places, const std::vector<double>& above,
                    double yaw) {
  if (places.size() < kLeastReturns) return 0;
  const Vector2 axis(std::cos(yaw), std::sin(yaw));
  std::vector<double> along;
  along.reserve(places.size());
  for (const Vector2& p : places) along.push_back(axis.dot(p));
  std::vector<double> sorted = along;
  const double rear = quantile(sorted, 0.005), length = quantile(sorted, 0.995) - rear;
  if (length < kShortest || length > kLongest) return 0;

  std::array<std::vector<double>, kCells> heights;
  for (std::size_t i = 0; i < along.size(); ++i) {
    const double cell = std::floor((along[i] - rear) / length * kCells);
    if (cell >= -1 && cell <= kCells)
      heights[static_cast<std::size_t>(std::clamp(cell, 0.0, kCells - 1.0))].push_back(above[i]);
  }
  // Line through the tops by least squares, over the length of the side.
  double n = 0, x = 0, z = 0, xx = 0, xz = 0;
  for (std::size_t i = 0; i < kCells; ++i) {
    if (heights[i].size() < kLeastInCell) continue;
    const double u = (static_cast<double>(i) + 0.5) / kCells, top = quantile(heights[i], 0.95);
    if (top > kHighest) return 0;
    n += 1, x += u, z += top, xx += u * u, xz += u * top;
  }
  if (n < kLeastTops) return 0;
  const double fall = -(n * xz - x * z) / (n * xx - x * x);
  return std::clamp(kPerFall * fall, -kMost, kMost);
}

}  // namespace perception
