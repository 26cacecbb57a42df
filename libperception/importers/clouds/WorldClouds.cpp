#include "libperception/importers/clouds/WorldClouds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "libperception/core/Error.h"

namespace perception {
namespace {

// All assumed.
constexpr double kFarFromOrigin = 30;                // [m] where a scan tells in which frame it is
constexpr std::size_t kLeastFar = 3, kLookedAt = 5;  // scans
constexpr double kTooFar = 2e5;                      // [m] where float32 is accurate to 8 mm

/// Whether the returns lie about a place, and not about the origin.
bool liesAbout(const Vector3& place, const LidarCloud& cloud) {
  constexpr double kClearly = 3;
  const auto distance = [&](const Vector3& from) {
    std::vector<double> all;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const double d = (Vector3(cloud.x[i], cloud.y[i], cloud.z[i]) - from).norm();
      if (std::isfinite(d)) all.push_back(d);
    }
    if (all.empty()) return 0.0;
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end());
    return *middle;
  };
  return kClearly * distance(place) < distance(Vector3::Zero());
}

}  // namespace

bool areInWorld(const std::vector<PlacedFile>& scans, const CloudFormat& format) {
  double most = kFarFromOrigin;
  for (const PlacedFile& scan : scans) most = std::max(most, scan.place.norm() / 2);
  std::vector<PlacedFile> far;
  std::copy_if(scans.begin(), scans.end(), std::back_inserter(far),
               [&](const PlacedFile& scan) { return scan.place.norm() >= most; });
  if (far.size() < kLeastFar) return false;
  for (std::size_t n = 0; n < kLookedAt; ++n) {
    const PlacedFile& scan = far[n * (far.size() - 1) / (kLookedAt - 1)];
    if (!liesAbout(scan.place, readCloudFile(scan.path, format))) return false;
    if (scan.place.norm() > kTooFar)
      throw DataError(
          fmt::format("{}: its returns are in the frame of the poses, {:.0f} m from its origin, "
                      "where float32 is too coarse: subtract a point near the drive from both",
                      scan.path, scan.place.norm()));
  }
  return true;
}

}  // namespace perception
