#include "libperception/doctor/motion/RadarVelocity.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace perception {

std::optional<SensorVelocity> radarVelocity(const RadarReturns& radar, Stamp stamp) {
  constexpr double kAgree = 0.3;                  // [m/s] about three times a radar's noise
  constexpr std::size_t kFewest = 5, kMost = 40;  // returns; of the pairs that are tried
  constexpr double kSpread = 0.02;                // least information across, per return
  std::vector<std::pair<Vector2, double>> all;    // direction, range rate
  for (const RadarReturn& r : radar.returns)
    if (r.has_rate) all.emplace_back(rotate2(r.bearing, Vector2(1, 0)), r.range_rate);
  if (all.size() < kFewest) return std::nullopt;
  const auto agrees = [&](const auto& r, const Vector2& v) {
    return std::abs(r.second + r.first.dot(v)) < kAgree;
  };
  const std::size_t every = all.size() / kMost + 1;
  Vector2 velocity = Vector2::Zero();
  std::size_t most = 0;
  for (std::size_t i = 0; i < all.size(); i += every) {
    for (std::size_t j = i + every; j < all.size(); j += every) {
      Matrix2 D;
      D << all[i].first.transpose(), all[j].first.transpose();
      if (std::abs(D.determinant()) < 0.1) continue;
      const Vector2 v = D.inverse() * -Vector2(all[i].second, all[j].second);
      const auto n = static_cast<std::size_t>(
          std::count_if(all.begin(), all.end(), [&](const auto& r) { return agrees(r, v); }));
      if (n > most) most = n, velocity = v;
    }
  }
  if (most < kFewest || 2 * most < all.size()) return std::nullopt;
  SensorVelocity out{stamp, velocity, Matrix2::Zero()};
  Vector2 sum = Vector2::Zero();
  for (const auto& r : all) {
    if (!agrees(r, velocity)) continue;
    out.information += r.first * r.first.transpose();
    sum -= r.first * r.second;
  }
  if (out.information.determinant() < kSpread * static_cast<double>(most * most))
    return std::nullopt;
  out.velocity = out.information.inverse() * sum;
  return out;
}

}  // namespace perception
