#include "libperception/packets/lidars/BeamView.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace perception {
namespace {

constexpr double kDegrees = 180 / M_PI;
constexpr double kMargin = 5;     ///< [deg] of the circle that is there twice
constexpr double kOutermost = 2;  ///< [deg] beyond the highest and lowest beam

}  // namespace

BeamView::BeamView(const LidarCloud& cloud, const std::vector<BeamAngles>& beams)
    : returns_(beams.size()) {
  std::vector<std::size_t> order(beams.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return beams[a].elevation < beams[b].elevation; });
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double flat = std::hypot(cloud.x[i], cloud.y[i]);
    const double range = std::hypot(flat, static_cast<double>(cloud.z[i]));
    if (!(range > 0)) continue;
    const double up = std::atan2(static_cast<double>(cloud.z[i]), flat) * kDegrees;
    const auto above = std::lower_bound(
        order.begin(), order.end(), up,
        [&](std::size_t beam, double value) { return beams[beam].elevation < value; });
    auto nearest = above == order.end() ? above - 1 : above;
    if (above != order.begin() && above != order.end() &&
        up - beams[*(above - 1)].elevation < beams[*above].elevation - up)
      --nearest;
    const bool outside = up < beams[order.front()].elevation - kOutermost ||
                         up > beams[order.back()].elevation + kOutermost;
    if (outside) continue;
    double azimuth =
        -std::atan2(static_cast<double>(cloud.y[i]), static_cast<double>(cloud.x[i])) * kDegrees;
    if (azimuth < 0) azimuth += 360;
    const Seen seen{range, cloud.intensity.empty() ? 0.5F : cloud.intensity[i]};
    auto& list = returns_[*nearest];
    list.push_back({azimuth, seen});
    if (azimuth < kMargin) list.push_back({azimuth + 360, seen});
    if (azimuth > 360 - kMargin) list.push_back({azimuth - 360, seen});
  }
  for (auto& list : returns_)
    std::sort(list.begin(), list.end(),
              [](const Return& a, const Return& b) { return a.azimuth < b.azimuth; });
}

std::optional<BeamView::Seen> BeamView::at(std::size_t beam, double azimuth, double step) const {
  azimuth -= 360 * std::floor(azimuth / 360);
  const auto& list = returns_[beam];
  auto it = std::lower_bound(list.begin(), list.end(), azimuth - step / 2,
                             [](const Return& r, double value) { return r.azimuth < value; });
  std::optional<Seen> nearest;
  for (; it != list.end() && it->azimuth < azimuth + step / 2; ++it) {
    if (!nearest || it->seen.range < nearest->range) nearest = it->seen;
  }
  return nearest;
}

}  // namespace perception
