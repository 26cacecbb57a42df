#include "libperception/measurement/frames/NoReturns.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace perception {
namespace {

// All assumed.
constexpr double kLeastLimit = 20;  // [m] the least range that a lidar gives instead of a return
constexpr double kSame = 2e-3, kSameShare = 1e-5;  // [m], of the range: equal
constexpr double kShare = 0.05;                    // of the returns
constexpr std::size_t kLeast = 50;                 // points
constexpr std::size_t kLeastOthers = 10;           // points that are nearer: else it is no scene
constexpr double kGap = 0.02, kInGap = 0.1;        // of the range, of the points
constexpr double kElevations = 0.02, kHorizon = 1e-3;  // [rad]
constexpr double kAlike = 0.01;  // of ranges: one number for all that is nothing

/// Points as far away as the farthest; none, if others are hardly nearer.
std::vector<std::size_t> pointsAt(const std::vector<double>& ranges, double farthest) {
  const double same = farthest - std::max(kSame, kSameShare * farthest);
  std::vector<std::size_t> points;
  std::size_t below = 0;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    if (ranges[i] >= same && ranges[i] <= farthest) points.push_back(i);
    below += ranges[i] >= (1 - kGap) * farthest && ranges[i] < same;
  }
  if (static_cast<double>(below) > kInGap * static_cast<double>(points.size())) points.clear();
  return points;
}

/// Whether points of one range are no ring that a beam draws on level ground: their elevations
/// differ, or they look along the horizon.
bool isNoRing(const std::vector<std::size_t>& points, double range, const LidarCloud& cloud) {
  double low = range, high = -range;
  for (const std::size_t i : points) {
    low = std::min(low, static_cast<double>(cloud.z[i]));
    high = std::max(high, static_cast<double>(cloud.z[i]));
  }
  return high - low >= kElevations * range || std::max(-low, high) <= kHorizon * range;
}

}  // namespace

NoReturns noReturnsOf(const LidarCloud& cloud) {
  NoReturns none;
  std::vector<double> ranges(cloud.size());
  std::size_t near = 0;
  double farthest = 0, least_beyond = std::numeric_limits<double>::infinity(), most_beyond = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto x = static_cast<double>(cloud.x[i]), y = static_cast<double>(cloud.y[i]),
               z = static_cast<double>(cloud.z[i]);
    const double range = ranges[i] = std::sqrt(x * x + y * y + z * z);
    if (range <= kFarthestReturn) {
      ++near, farthest = std::max(farthest, range);
    } else if (std::isfinite(range)) {
      none.points.push_back(i);
      least_beyond = std::min(least_beyond, range), most_beyond = std::max(most_beyond, range);
    }
  }
  const bool differ = most_beyond > (1 + kAlike) * least_beyond || near < kLeastOthers;
  none.elsewhere = none.points.size() > near && differ;
  const std::vector<std::size_t> limit = pointsAt(ranges, farthest);
  const bool many = limit.size() >= kLeast &&
                    static_cast<double>(limit.size()) >= kShare * static_cast<double>(near);
  if (farthest >= kLeastLimit && many && near - limit.size() >= kLeastOthers &&
      isNoRing(limit, farthest, cloud))
    none.points.insert(none.points.end(), limit.begin(), limit.end());
  return none;
}

std::size_t clear(const NoReturns& none, LidarCloud& cloud) {
  for (const std::size_t i : none.points)
    cloud.x[i] = cloud.y[i] = cloud.z[i] = std::numeric_limits<float>::quiet_NaN();
  return none.points.size();
}

}  // namespace perception
