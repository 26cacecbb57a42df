#include "libperception/evaluation/matching/Footprint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace perception {
namespace {

constexpr double kRounding = 1e-12;

TEST(Footprint, ClosestPointIsOnTheNearSideOfARectangle) {
  const Footprint car{{10, 0}, 0, 4, 2};
  EXPECT_LT((closestPoint(car, {0, 0}) - Vector2(8, 0)).norm(), kRounding);
  EXPECT_LT((closestPoint(car, {0, 5}) - Vector2(8, 1)).norm(), kRounding);    // a corner
  EXPECT_LT((closestPoint(car, {10, 9}) - Vector2(10, 1)).norm(), kRounding);  // a side
}

TEST(Footprint, ATurnedCarShowsItsSide) {
  const Footprint car{{10, 0}, kPi / 2, 4, 2};
  EXPECT_LT((closestPoint(car, {0, 0}) - Vector2(9, 0)).norm(), kRounding);
  EXPECT_LT((closestPoint(car, {0, 5}) - Vector2(9, 2)).norm(), kRounding);
}

TEST(Footprint, APointInsideIsItsOwnClosestPoint) {
  const Footprint car{{3, -2}, 0.7, 4, 2};
  EXPECT_LT((closestPoint(car, {3.2, -1.9}) - Vector2(3.2, -1.9)).norm(), kRounding);
}

TEST(Footprint, AgreesWithADenselySampledBorder) {
  const Footprint box{{4, 3}, 0.4, 5, 1.5};
  const Vector2 from(-1, 2);
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= 2000; ++i) {
    const double s = i / 2000.0 - 0.5;
    for (const Vector2& p : {Vector2(s * 5, .75), Vector2(s * 5, -.75), Vector2(2.5, s * 1.5),
                             Vector2(-2.5, s * 1.5)}) {
      best = std::min(best, (box.center + rotate2(box.yaw, p) - from).norm());
    }
  }
  EXPECT_NEAR((closestPoint(box, from) - from).norm(), best, 1e-5);
}

TEST(Footprint, UnknownSizeAndYawMakeAPoint) {
  const double nan = std::nan("");
  const Footprint point = makeFootprint({1, 2, 0}, nan, nan, -1);
  EXPECT_EQ(point.yaw, 0);
  EXPECT_LT((closestPoint(point, {0, 0}) - Vector2(1, 2)).norm(), kRounding);
}

TEST(GroundView, IsInTheFrameOfTheVehicle) {
  const Pose3 ego = makePose(5, 5, 0, kPi / 2);
  const GroundView view = viewFrom(ego, Footprint{{5, 15}, 0, 0, 4});
  EXPECT_NEAR(view.range, 10, kRounding);
  EXPECT_NEAR(view.closest_range, 8, kRounding);
  EXPECT_NEAR(view.bearing, 0, kRounding);
  EXPECT_NEAR(viewFrom(ego, Footprint{{0, 5}, 0, 0, 0}).bearing, kPi / 2, kRounding);
}

TEST(GroundView, TheSectorHoldsItsBordersAndNothingBehind) {
  const auto seen = [](double x, double y) {
    return viewFrom(Pose3::Identity(), Footprint{{x, y}, 0, 0, 0});
  };
  EXPECT_TRUE(inSector(seen(0, 20), 20, kPi));
  EXPECT_TRUE(inSector(seen(0, -20), 20, kPi));
  EXPECT_TRUE(inSector(seen(20, 0), 20, kPi));
  EXPECT_FALSE(inSector(seen(20.01, 0), 20, kPi));
  EXPECT_FALSE(inSector(seen(-0.01, 5), 20, kPi));
  EXPECT_TRUE(inSector(seen(-5, 0), 20, kTwoPi));
  EXPECT_FALSE(inSector(seen(5, 5.01), 20, kPi / 2));
  EXPECT_FALSE(inSector(seen(std::nan(""), 0), 20, kTwoPi));
}

}  // namespace
}  // namespace perception
