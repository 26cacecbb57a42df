#include "libperception/lidar/outline/BoxFit.h"

#include <gtest/gtest.h>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

/// Returns on those sides of a rectangle that face a sensor at the origin.
std::vector<Vector2> facingSides(const Vector2& center, double yaw, double length, double width,
                                 double noise = 0.01) {
  std::vector<Vector2> points;
  Rng rng(RngKey{3, 0, 0, 12});
  const Vector2 u = rotate2(yaw, {1, 0}), v = rotate2(yaw, {0, 1});
  const auto side = [&](const Vector2& middle, const Vector2& along, double size,
                        const Vector2& normal) {
    if (normal.dot(middle) >= 0) return;  // looks away
    for (double t = -0.5; t <= 0.5; t += 0.02)
      points.push_back(middle + t * size * along + rng.normal(0, noise) * normal);
  };
  side(center + width / 2 * v, u, length, v), side(center - width / 2 * v, u, length, -v);
  side(center + length / 2 * u, v, width, u), side(center - length / 2 * u, v, width, -u);
  return points;
}

TEST(Hull, OfASquareWithInnerPointsIsItsCorners) {
  std::vector<Vector2> points;
  for (int i = 0; i <= 10; ++i)
    for (int j = 0; j <= 10; ++j) points.emplace_back(i, j);
  const auto hull = convexHull(points);
  ASSERT_EQ(hull.size(), 4u);
  EXPECT_EQ(hull[0], Vector2(0, 0));
  EXPECT_EQ(hull[1], Vector2(10, 0));  // counter-clockwise
  EXPECT_NEAR(sizeOf(hull).longest, 10, 1e-12);
  EXPECT_NEAR(sizeOf(hull).area, 100, 1e-9);
}

TEST(Hull, ContainsAllPointsAndTurnsLeftOnly) {
  Rng rng(RngKey{8, 0, 0, 12});
  for (int round = 0; round < 50; ++round) {
    std::vector<Vector2> points;
    for (int i = 0; i < 3 + round * 5; ++i)
      points.emplace_back(rng.normal(0, 3), rng.normal(10, 1));
    const auto hull = convexHull(points);
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const Vector2 a = hull[i], side = hull[(i + 1) % hull.size()] - a;
      for (const Vector2& p : points)
        ASSERT_GE(side.x() * (p - a).y() - side.y() * (p - a).x(), -1e-12);
    }
  }
}

TEST(Hull, DistanceIsZeroInsideAndEuclideanOutside) {
  const std::vector<Vector2> square = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
  EXPECT_EQ(distanceToHull(square, {1, 1}), 0);
  EXPECT_NEAR(distanceToHull(square, {1, -3}), 3, 1e-12);
  EXPECT_NEAR(distanceToHull(square, {5, 6}), 5, 1e-12);
  EXPECT_NEAR(distanceToHull({{1, 1}}, {4, 5}), 5, 1e-12);
}

TEST(BoxFit, FindsDirectionAndSizeOfAnLShape) {
  for (int k = 0; k < 18; ++k) {
    const double yaw = radians(10.0 * k - 85);
    const Vector2 center(12, 5);
    if (std::abs(wrapAxis(yaw - std::atan2(5, 12))) < radians(8)) continue;  // shows its rear alone
    const auto sides = fitBox(facingSides(center, yaw, 4.4, 1.8), Vector2::Zero(), true, true, {});
    ASSERT_TRUE(sides);
    EXPECT_NEAR(degrees(wrapAxis(sides->yaw - yaw)), 0, 1.5) << k;
    EXPECT_NEAR(sides->length, 4.4, 0.15) << k;
    EXPECT_LT(std::abs(degrees(wrapAxis(sides->yaw - yaw))), 3 * degrees(sides->yaw_sigma)) << k;
  }
}

TEST(BoxFit, BothSidesOfAFreeCornerAreComplete) {
  const auto sides =
      fitBox(facingSides({12, 5}, radians(60), 4.4, 1.8), Vector2::Zero(), true, true, {});
  ASSERT_TRUE(sides);
  EXPECT_TRUE(sides->length_complete);
  EXPECT_TRUE(sides->width_complete);
  EXPECT_NEAR(sides->width, 1.8, 0.15);
  EXPECT_NEAR((sides->center - Vector2(12, 5)).norm(), 0, 0.15);
}

TEST(BoxFit, AHiddenEdgeLeavesItsSideOpen) {
  // Length across the line of sight, long side seen; its left end is the outline's left edge.
  const auto points = facingSides({12, 0.4}, radians(80), 4.4, 1.8);
  const auto left_hidden = fitBox(points, Vector2::Zero(), false, true, {});
  const auto right_hidden = fitBox(points, Vector2::Zero(), true, false, {});
  ASSERT_TRUE(left_hidden && right_hidden);
  EXPECT_FALSE(left_hidden->length_complete);
  EXPECT_FALSE(right_hidden->length_complete);
}

TEST(BoxFit, ACarSeenFromBehindShowsItsWidthAlone) {
  const auto points =
      facingSides({15, 0}, 0, 4.4, 1.8);  // rear only: one side across the line of sight
  const auto sides = fitBox(points, Vector2::Zero(), true, true, {});
  ASSERT_TRUE(sides);
  EXPECT_NEAR(sides->length, 1.8, 0.1);
  EXPECT_TRUE(sides->length_complete);
  EXPECT_FALSE(sides->width_complete);
  EXPECT_NEAR(std::abs(degrees(sides->yaw)), 90, 2);
}

// A rear of 1.8 m tells its direction to 13 degrees only: turned by a cloud beside it, it seems to
// show a short side. A long side tells its direction better.
TEST(BoxFit, AShortSideIsCompleteOnlyWhereTheDirectionIsSureEnough) {
  for (const double longer : {1.8, 4.4}) {
    const auto sides =
        fitBox(facingSides({20, 0}, radians(119), longer, 0.6), Vector2::Zero(), true, true, {});
    ASSERT_TRUE(sides);
    EXPECT_NEAR(degrees(wrapAxis(sides->yaw - radians(119))), 0, 3);
    EXPECT_TRUE(sides->length_complete);
    EXPECT_EQ(sides->width_complete, longer > 4);
  }
}

TEST(BoxFit, ARoundGroupHasNoDirection) {
  std::vector<Vector2> points;
  Rng rng(RngKey{5, 0, 0, 12});
  for (int i = 0; i < 300; ++i) {
    const double angle = rng.uniform(0, kTwoPi), r = 0.8 * std::sqrt(rng.uniform());
    points.emplace_back(10 + r * std::cos(angle), r * std::sin(angle));
  }
  const auto round = fitBox(points, Vector2::Zero(), true, true, {});
  const auto car =
      fitBox(facingSides({12, 5}, radians(60), 4.4, 1.8), Vector2::Zero(), true, true, {});
  ASSERT_TRUE(round && car);
  EXPECT_GT(degrees(round->yaw_sigma), 15);
  EXPECT_LT(degrees(car->yaw_sigma), 8);
}

TEST(BoxFit, ABollardBesideACarDoesNotWidenIt) {
  auto points = facingSides({12, 5}, radians(60), 4.4, 1.8);
  points.push_back(Vector2(12, 5) + rotate2(radians(60), {-2, 1.4}));
  const auto sides = fitBox(points, Vector2::Zero(), true, true, {});
  ASSERT_TRUE(sides);
  EXPECT_NEAR(sides->width, 1.8, 0.15);
  EXPECT_NEAR(degrees(sides->yaw), 60, 1.5);
}

TEST(BoxFit, OnePlaceHasNoBox) {
  EXPECT_FALSE(fitBox({{3, 4}}, Vector2::Zero(), true, true, {}));
  EXPECT_FALSE(fitBox({{3, 4}, {3, 4}}, Vector2::Zero(), true, true, {}));
}

}  // namespace
}  // namespace perception
