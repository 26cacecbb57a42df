#include "libperception/lidar/LooseReturns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace perception {
namespace {

constexpr double kBeam = radians(0.2), kRear = 8, kPlume = 7;  // [rad], [m], [m]

/// Beams from a sensor at 1.7 m to a flat rear that fills 40 by 20 of them, 0.2 deg apart; every
/// `plume`-th beam returns from a meter before it (0: none).
EgoPoints rearSeen(int plume) {
  EgoPoints all;
  all.sensor = Vector3(0, 0, 1.7);
  int beam = 0;
  for (int row = -20; row < 0; ++row) {
    for (int column = -20; column < 20; ++column, ++beam) {
      const double range = plume > 0 && beam % plume == 0 ? kPlume : kRear;
      const double azimuth = column * kBeam, elevation = row * kBeam;
      all.x.push_back(static_cast<float>(range * std::cos(elevation) * std::cos(azimuth)));
      all.y.push_back(static_cast<float>(range * std::cos(elevation) * std::sin(azimuth)));
      all.z.push_back(static_cast<float>(1.7 + range * std::sin(elevation)));
    }
  }
  return all;
}

std::vector<std::uint32_t> indicesOf(const EgoPoints& all) {
  std::vector<std::uint32_t> points(all.size());
  std::iota(points.begin(), points.end(), 0u);
  return points;
}

TEST(LooseReturns, OfASurfaceAloneNoneIs) {
  const EgoPoints all = rearSeen(0);
  EXPECT_EQ(surfaceReturns(all, DirectionCells(all), indicesOf(all)), indicesOf(all));
}

TEST(LooseReturns, ThosePassedByMostBeamsAre) {
  const EgoPoints all = rearSeen(11);
  const auto kept = surfaceReturns(all, DirectionCells(all), indicesOf(all));
  std::size_t rear = 0;
  for (std::uint32_t i = 0; i < all.size(); ++i) rear += i % 11 != 0;
  EXPECT_EQ(kept.size(), rear);
  for (const std::uint32_t i : kept) EXPECT_NE(i % 11, 0u);
}

TEST(LooseReturns, AClusterOfMoreThanHalfLooseOnesStaysWhole) {
  const EgoPoints all = rearSeen(11);
  std::vector<std::uint32_t> plume;
  for (std::uint32_t i = 0; i < all.size(); i += 11) plume.push_back(i);
  std::vector<std::uint32_t> whole(plume.size());
  std::iota(whole.begin(), whole.end(), 0u);
  EXPECT_EQ(surfaceReturns(all, DirectionCells(all), plume), whole);
}

}  // namespace
}  // namespace perception
