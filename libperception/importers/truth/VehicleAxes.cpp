#include "libperception/importers/truth/VehicleAxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "libperception/core/math/Median.h"

namespace perception {
namespace {

// All assumed.
constexpr double kNearestRoad = 4, kFarthestRoad = 20;  // [m]
constexpr double kLeastHeight = 0.5, kMostHeight = 4;   // [m] of a lidar
constexpr double kHeightBin = 0.05;                     // [m]
constexpr std::size_t kRoadReturns = 100;               // in the bin and those beside it
constexpr std::size_t kRoadScans = 20;
constexpr double kTravelStep = 0.5;  // [m]

std::optional<double> heightIn(const LidarCloud& cloud) {
  constexpr auto kBins = static_cast<std::size_t>((kMostHeight - kLeastHeight) / kHeightBin);
  std::array<std::size_t, kBins + 2> counts{};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto x = static_cast<double>(cloud.x[i]), y = static_cast<double>(cloud.y[i]);
    const double range = std::hypot(x, y), below = -static_cast<double>(cloud.z[i]);
    const bool near = range >= kNearestRoad && range <= kFarthestRoad;
    if (near && below >= kLeastHeight && below < kMostHeight)
      ++counts[1 +
               std::min(static_cast<std::size_t>((below - kLeastHeight) / kHeightBin), kBins - 1)];
  }
  std::size_t best = 0, most = 0;
  for (std::size_t i = 1; i <= kBins; ++i) {
    const std::size_t about = counts[i - 1] + counts[i] + counts[i + 1];
    if (about > most) most = about, best = i;
  }
  if (most < kRoadReturns) return {};
  // The middle of the returns in the three bins.
  const double lean =
      (static_cast<double>(counts[best + 1]) - static_cast<double>(counts[best - 1])) /
      static_cast<double>(most);
  return kLeastHeight + (static_cast<double>(best) - 0.5 + lean) * kHeightBin;
}

}  // namespace

std::optional<double> heightAboveRoad(const std::vector<FrameFile>& scans,
                                      const std::function<LidarCloud(const std::string&)>& read) {
  std::vector<double> heights;
  const std::size_t step = scans.size() / kRoadScans + 1;
  for (std::size_t i = 0; i < scans.size(); i += step)
    if (const auto height = heightIn(read(scans[i].path))) heights.push_back(*height);
  if (heights.empty()) return {};
  return medianOf(std::move(heights));
}

std::optional<Vector3> travelDirection(const std::vector<StampedPose>& poses) {
  Vector3 sum = Vector3::Zero();
  double steps = 0;
  std::size_t from = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Vector3 step = poses[i].pose.translation() - poses[from].pose.translation();
    if (step.norm() < kTravelStep) continue;
    sum += poses[from].pose.linear().transpose() * step.normalized();
    ++steps;
    from = i;
  }
  if (steps == 0) return {};
  return sum / steps;
}

double intensityScaleOf(const std::vector<FrameFile>& scans,
                        const std::function<LidarCloud(const std::string&)>& read) {
  constexpr std::size_t kScans = 3;
  constexpr double kBrightest = 255;
  for (std::size_t i = 0; i < std::min(scans.size(), kScans); ++i) {
    const LidarCloud cloud = read(scans[i].path);
    if (std::any_of(cloud.intensity.begin(), cloud.intensity.end(), [](float v) { return v > 1; }))
      return kBrightest;
  }
  return 1;
}

}  // namespace perception
