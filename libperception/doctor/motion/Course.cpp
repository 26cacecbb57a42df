#include "libperception/doctor/motion/Course.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libperception/core/PoseSteps.h"

namespace perception {
namespace {

constexpr double kLongestGap = 1.0;  ///< [s] between two poses

}  // namespace

Course::Course(std::vector<EgoState> poses) : poses_(std::move(poses)) {
  std::stable_sort(poses_.begin(), poses_.end(),
                   [](const EgoState& a, const EgoState& b) { return a.stamp < b.stamp; });
  poses_.erase(std::unique(poses_.begin(), poses_.end(),
                           [](const auto& a, const auto& b) { return a.stamp == b.stamp; }),
               poses_.end());
}

std::optional<Pose3> Course::at(Stamp stamp, double later) const {
  const Stamp t{stamp.ns + static_cast<std::int64_t>(std::llround(later * 1e9))};
  const auto next = std::lower_bound(poses_.begin(), poses_.end(), t,
                                     [](const EgoState& a, Stamp b) { return a.stamp < b; });
  if (next == poses_.end() || (next == poses_.begin() && t < next->stamp)) return std::nullopt;
  if (next->stamp == t) return next->T_world_ego;
  const EgoState &a = *(next - 1), &b = *next;
  const double gap = b.stamp - a.stamp;
  if (gap > kLongestGap) return std::nullopt;
  return interpolate(a.T_world_ego, b.T_world_ego, (t - a.stamp) / gap);
}

std::optional<Pose3> Course::motion(Stamp from, Stamp to, double later) const {
  const auto a = at(from, later), b = at(to, later);
  if (!a || !b) return std::nullopt;
  return a->inverse() * *b;
}

}  // namespace perception
