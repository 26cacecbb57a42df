#include "libperception/lidar/segments/LooseReturns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

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

/// Adds one row of beams, 0.4 deg apart, on a side at y = 2.5 m from 16 to 24 m: from column to
/// column the range grows by up to 1.6 m. The row above passes over it, that below ends on the road
/// before it. Returns how many are on the side; they come first.
std::size_t addSide(EgoPoints& all) {
  constexpr double kSide = 2.5, kStep = radians(0.4);
  std::vector<double> azimuths;
  for (double a = std::atan2(kSide, 24); a < std::atan2(kSide, 16); a += kStep)
    azimuths.push_back(a);
  for (const int row : {-2, -1, -3}) {
    for (const double azimuth : azimuths) {
      const double range = row == -2 ? kSide / std::sin(azimuth) : row == -1 ? 60 : 12;
      all.x.push_back(static_cast<float>(range * std::cos(azimuth)));
      all.y.push_back(static_cast<float>(range * std::sin(azimuth)));
      all.z.push_back(static_cast<float>(1.7 + range * std::tan((row + 0.5) * kStep)));
    }
  }
  return azimuths.size();
}

TEST(LooseReturns, OfASideSeenAtAGrazingAngleNoneIs) {
  EgoPoints all = rearSeen(0);
  auto points = indicesOf(all);
  const std::size_t side = addSide(all);
  ASSERT_GT(side, 5u);
  for (std::size_t k = 0; k < side; ++k)
    points.push_back(static_cast<std::uint32_t>(points.size()));
  EXPECT_EQ(surfaceReturns(all, DirectionCells(all), points), points);
}

TEST(LooseReturns, AClusterOfMoreThanHalfLooseOnesStaysWhole) {
  const EgoPoints all = rearSeen(11);
  std::vector<std::uint32_t> plume;
  for (std::uint32_t i = 0; i < all.size(); i += 11) plume.push_back(i);
  std::vector<std::uint32_t> whole(plume.size());
  std::iota(whole.begin(), whole.end(), 0u);
  EXPECT_EQ(surfaceReturns(all, DirectionCells(all), plume), whole);
}

/// Moves `count` by `count` of the beams to 0.6 m before the rear: what hangs there lets none pass.
void addLump(int count, EgoPoints& all) {
  for (int row = 8; row < 8 + count; ++row) {
    for (int column = 16; column < 16 + count; ++column) {
      const auto i = static_cast<std::size_t>(row * 40 + column);
      const auto scale = static_cast<float>((kRear - 0.6) / kRear);
      all.x[i] *= scale, all.y[i] *= scale;
      all.z[i] = 1.7f + (all.z[i] - 1.7f) * scale;
    }
  }
}

double nearestOf(const EgoPoints& all, const std::vector<std::uint32_t>& kept) {
  double nearest = 1e9;
  for (const std::uint32_t i : kept)
    nearest = std::min(nearest, static_cast<double>(std::hypot(all.x[i], all.y[i])));
  return nearest;
}

TEST(LooseReturns, WithAPlumeItsDenseLumpsAreNoSurface) {
  EgoPoints all = rearSeen(11);
  addLump(6, all);
  const auto kept = surfaceReturns(all, DirectionCells(all), indicesOf(all));
  EXPECT_GT(nearestOf(all, kept), kRear - 0.05);
  EXPECT_GT(kept.size(), 650u) << "of 727 on the rear without the lump";
}

TEST(LooseReturns, WithoutAPlumeWhatStandsOutStays) {
  EgoPoints all = rearSeen(0);
  addLump(6, all);
  const auto kept = surfaceReturns(all, DirectionCells(all), indicesOf(all));
  EXPECT_LT(nearestOf(all, kept), kRear - 0.5);
}

/// The same rear, `range` [m] away; in front of it every fourth beam ends on a flake from 4 m on.
EgoPoints rearInSnow(double range, std::vector<std::uint32_t>* flakes) {
  EgoPoints all = rearSeen(0);
  std::minstd_rand random(1);
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    const bool flake = random() % 4 == 0;
    const auto to =
        static_cast<float>(flake ? 4 + 1e-3 * static_cast<double>(random() % 5000) : range);
    const float scale = to / static_cast<float>(kRear);
    all.x[i] *= scale, all.y[i] *= scale;
    all.z[i] = static_cast<float>(all.sensor.z()) +
               (all.z[i] - static_cast<float>(all.sensor.z())) * scale;
    if (flake) flakes->push_back(i);
  }
  return all;
}

double shareAbove(const std::vector<float>& shares, float least) {
  const auto above =
      std::count_if(shares.begin(), shares.end(), [least](float s) { return s >= least; });
  return static_cast<double>(above) / static_cast<double>(shares.size());
}

TEST(SolidShares, OfASurfaceAlmostEveryDirectionEndsThere) {
  const EgoPoints all = rearSeen(0);
  EXPECT_EQ(shareAbove(solidShares(DirectionCells(all), indicesOf(all)), 0.99F), 1);
}

TEST(SolidShares, OfFlakesBeforeASurfaceFewDo) {
  std::vector<std::uint32_t> flakes;
  const EgoPoints all = rearInSnow(20, &flakes);
  ASSERT_GT(flakes.size(), 150u);
  EXPECT_EQ(shareAbove(solidShares(DirectionCells(all), flakes), 0.55F), 0);
}

TEST(SolidShares, OfASurfaceBehindFlakesMostStillDo) {
  std::vector<std::uint32_t> flakes, surface;
  const EgoPoints all = rearInSnow(20, &flakes);
  for (const std::uint32_t i : indicesOf(all))
    if (!std::binary_search(flakes.begin(), flakes.end(), i)) surface.push_back(i);
  EXPECT_EQ(shareAbove(solidShares(DirectionCells(all), surface), 0.75F), 1);
}

TEST(SolidShares, FlakesAreNoSurfaceWhereNothingIsBehindThem) {
  std::vector<std::uint32_t> flakes;
  const EgoPoints all = rearInSnow(20, &flakes);
  EgoPoints sky;  // as of beams above the horizon
  sky.sensor = all.sensor;
  for (const std::uint32_t i : flakes) {
    sky.x.push_back(all.x[i]), sky.y.push_back(all.y[i]), sky.z.push_back(all.z[i]);
  }
  EXPECT_LT(shareAbove(solidShares(DirectionCells(sky), indicesOf(sky)), 0.55F), 0.1);
}

/// Fog of 50 m of sight before an open sky: each of 100 by 50 beams, 0.2 deg by 0.4 deg apart,
/// returns from 2.2 to 9 m, as likely from between 3 and 4.5 m as from between 6 and 9 m
/// (method.md 9.3).
EgoPoints denseFog() {
  EgoPoints all;
  all.sensor = Vector3(0, 0, 1.7);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> doublings(-1, 1);
  for (int row = -25; row < 25; ++row) {
    for (int column = -50; column < 50; ++column) {
      const double range = 4.5 * std::exp2(doublings(random));
      const double azimuth = column * kBeam, elevation = (row + 0.5) * 2 * kBeam;
      all.x.push_back(static_cast<float>(range * std::cos(elevation) * std::cos(azimuth)));
      all.y.push_back(static_cast<float>(range * std::cos(elevation) * std::sin(azimuth)));
      all.z.push_back(static_cast<float>(1.7 + range * std::sin(elevation)));
    }
  }
  return all;
}

TEST(SolidShares, TheFarEdgeOfFogIsNoSurface) {
  const EgoPoints fog = denseFog();
  EXPECT_LT(shareAbove(solidShares(DirectionCells(fog), indicesOf(fog)), 0.55F), 1e-3);
}

TEST(SolidShares, ASurfaceAtTheFarEdgeOfFogIsOne) {
  EgoPoints fog = denseFog();  // which hides every fourth beam of what stands at 8 m
  std::vector<std::uint32_t> surface;
  for (std::uint32_t i = 0; i < fog.size(); ++i) {
    const auto column = i % 100, row = i / 100;
    if (column < 30 || column >= 70 || row < 15 || row >= 35 || (column + row) % 4 == 0) continue;
    const Vector3 fog_place(fog.x[i], fog.y[i], fog.z[i]);
    const Vector3 place = fog.sensor + 8 * (fog_place - fog.sensor).normalized();
    fog.x[i] = static_cast<float>(place.x()), fog.y[i] = static_cast<float>(place.y());
    fog.z[i] = static_cast<float>(place.z());
    surface.push_back(i);
  }
  EXPECT_GT(shareAbove(solidShares(DirectionCells(fog), surface), 0.75F), 0.8);
}

TEST(SolidShares, APersonAtTheEdgeOfTheCellsIsLookedAt) {
  EgoPoints all;
  all.sensor = Vector3(0, 0, 1.7);
  for (int row = 0; row < 20; ++row) {  // steeply above, where the circle of the columns closes
    for (int column = -10; column < 10; ++column) {
      const double azimuth = kPi + column * kBeam, elevation = radians(26) + row * kBeam;
      all.x.push_back(static_cast<float>(5 * std::cos(elevation) * std::cos(azimuth)));
      all.y.push_back(static_cast<float>(5 * std::cos(elevation) * std::sin(azimuth)));
      all.z.push_back(static_cast<float>(1.7 + 5 * std::sin(elevation)));
    }
  }
  EXPECT_EQ(shareAbove(solidShares(DirectionCells(all), indicesOf(all)), 0.99F), 1);
}

}  // namespace
}  // namespace perception
