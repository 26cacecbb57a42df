#include "libperception/lidar/outline/RangeFlow.h"

#include <gtest/gtest.h>

#include <random>

namespace perception {
namespace {

constexpr double kDt = 0.1;
constexpr std::size_t kCells = 50;

/// In each cell a surface 20 m away that was `way` [m] nearer before.
RangeFlow surface(double way, std::size_t cells = kCells) {
  RangeFlow ways(cells);
  for (std::size_t c = 0; c < cells; ++c) {
    const auto range = static_cast<float>(20 + 0.01 * static_cast<double>(c));
    ways.addNow(c, range);
    ways.addBefore(c, range - static_cast<float>(way));
  }
  return ways;
}

/// The same with `drops` returns of a cloud before it in each cell, elsewhere in each scan.
RangeFlow inACloud(double way, int drops) {
  RangeFlow ways = surface(way);
  std::mt19937 rng(1);
  std::uniform_real_distribution<float> before(16, 20);
  for (std::size_t c = 0; c < kCells; ++c)
    for (int k = 0; k < drops; ++k) ways.addNow(c, before(rng)), ways.addBefore(c, before(rng));
  return ways;
}

TEST(RangeFlow, WhatIsRigidMovesByTheSameWayInAllDirections) {
  for (const double way : {1.39, -2.5, 4.0}) {
    const auto found = surface(way).way(kDt);
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found, way, 0.06);
  }
}

TEST(RangeFlow, ACloudBeforeItHidesTheWayOfNoSurface) {
  const auto found = inACloud(1.39, 1).way(kDt);
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 1.39, 0.06);
}

TEST(RangeFlow, ACloudHasNoWay) {
  RangeFlow cloud(kCells);
  std::mt19937 rng(2);
  std::uniform_real_distribution<float> range(16, 20);
  for (std::size_t c = 0; c < kCells; ++c)
    cloud.addNow(c, range(rng)), cloud.addBefore(c, range(rng));
  EXPECT_FALSE(cloud.way(kDt));
}

TEST(RangeFlow, WhatIsSlowOrTooFastForARoadUserHasNone) {
  EXPECT_FALSE(surface(0).way(kDt));
  EXPECT_FALSE(surface(0.2).way(kDt));
  EXPECT_FALSE(surface(5).way(kDt));
  EXPECT_TRUE(surface(0.4).way(kDt)) << "4 m/s";
}

TEST(RangeFlow, AFewDirectionsTellNothing) {
  EXPECT_FALSE(surface(1.4, 9).way(kDt));
  EXPECT_TRUE(surface(1.4, 11).way(kDt));
}

TEST(RangeFlow, TwoObjectsThatMoveByTheirOwnWaysHaveNone) {
  RangeFlow ways(kCells);
  for (std::size_t c = 0; c < kCells; ++c)
    ways.addNow(c, 20), ways.addBefore(c, c % 2 == 0 ? 18.6F : 17.8F);
  EXPECT_FALSE(ways.way(kDt));
}

TEST(RangeFlow, ReturnsAgreeWhoseCellHadOneByThatWayNearer) {
  const RangeFlow ways = surface(1.4);
  EXPECT_TRUE(ways.seenBefore(3));
  EXPECT_TRUE(ways.agrees(3, 20.05F, 1.4));
  EXPECT_FALSE(ways.agrees(3, 19.5F, 1.4));
}

TEST(RangeFlow, BeforeCountsOnlyWhereSomethingIsNow) {
  RangeFlow ways(1);
  ways.addBefore(0, 20);
  EXPECT_FALSE(ways.seenBefore(0));
}

}  // namespace
}  // namespace perception
