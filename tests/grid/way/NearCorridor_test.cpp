#include "libperception/grid/way/NearCorridor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

constexpr double kEnd = 40;  // [m]

/// A vehicle far from the world's origin.
Corridor bentCorridor(double curvature, bool backward) {
  Corridor corridor;
  corridor.T_world_ego = makePose(512000, -80, 1, 2.2, radians(3), radians(-2));
  corridor.curvature = curvature;
  corridor.backward = backward;
  corridor.max = kEnd;
  return corridor;
}

/// All around the vehicle, in steps that no number of the corridor divides.
GridPoints pointsAround(const Corridor& corridor) {
  GridPoints points;
  for (double x = -90; x < 90; x += 0.613)
    for (double y = -90; y < 90; y += 0.471)
      points.push_back(corridor.T_world_ego * Vector3(x, y, 0.5 + 0.01 * y));
  return points;
}

bool isInside(const Corridor& corridor, const Vector3& world) {
  const Vector3 p = corridor.T_world_ego.inverse() * world;
  const ArcPlace place = arcPlace(corridor, p.x(), p.y());
  return std::abs(place.d) <= corridor.width / 2 && std::abs(place.s) <= kEnd;
}

TEST(NearCorridor, HoldsAllThatLiesInTheCorridorHoweverItBends) {
  for (const bool backward : {false, true}) {
    for (const double curvature : {0.0, 0.003, 0.02, -0.08, 0.2, -0.2}) {
      const Corridor corridor = bentCorridor(curvature, backward);
      const GridPoints points = pointsAround(corridor);
      const auto near = nearCorridor(corridor, kEnd, points);
      std::size_t inside = 0;
      for (std::uint32_t i = 0; i < points.size(); ++i) {
        if (!isInside(corridor, points[i])) continue;
        ++inside;
        EXPECT_TRUE(std::binary_search(near.begin(), near.end(), i)) << curvature << " " << i;
      }
      EXPECT_GT(inside, 100U);
    }
  }
}

TEST(NearCorridor, LeavesOutNearlyAllThatLiesBesideIt) {
  for (const double curvature : {0.0, 0.02, -0.05}) {
    const Corridor corridor = bentCorridor(curvature, false);
    const GridPoints points = pointsAround(corridor);
    EXPECT_LT(nearCorridor(corridor, kEnd, points).size(), points.size() / 20) << curvature;
  }
}

TEST(ArcPlaceWithin, IsThePlaceOfThoseThatLieNoFartherBesideTheArc) {
  constexpr double kSide = 1.5;  // [m]
  for (const bool backward : {false, true}) {
    for (const double curvature : {0.0, 0.003, -0.08}) {
      const Corridor corridor = bentCorridor(curvature, backward);
      int within = 0;
      for (double x = -20; x < 20; x += 0.613) {
        for (double y = -20; y < 20; y += 0.471) {
          const ArcPlace place = arcPlace(corridor, x, y);
          const auto found = arcPlaceWithin(corridor, x, y, kSide);
          ASSERT_EQ(found.has_value(), std::abs(place.d) <= kSide) << x << " " << y;
          EXPECT_EQ(alongArc(corridor, x, y), place.s);
          if (!found) continue;
          EXPECT_EQ(found->s, place.s);
          EXPECT_EQ(found->d, place.d);
          ++within;
        }
      }
      EXPECT_GT(within, 100);
    }
  }
}

TEST(NearCorridor, LeavesOutPointsThatAreNotFinite) {
  const Corridor corridor = bentCorridor(0, false);
  GridPoints points;
  points.push_back(corridor.T_world_ego * Vector3(10, 0, 1));
  points.push_back(Vector3::Constant(std::numeric_limits<double>::quiet_NaN()));
  points.push_back(Vector3::Constant(std::numeric_limits<double>::infinity()));
  EXPECT_EQ(nearCorridor(corridor, kEnd, points), std::vector<std::uint32_t>{0});
}

}  // namespace
}  // namespace perception
