#include "libperception/lidar/outline/FrontShape.h"

#include <gtest/gtest.h>

#include <functional>
#include <utility>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Random.h"

namespace perception {
namespace {

struct SideView {
  std::vector<Vector2> places;
  std::vector<double> above;
  double logOdds(double yaw) const { return frontLogOdds(places, above, yaw); }
};

/// Returns from the side of something that begins at (10, 5) and lies along `yaw`, `length` [m]
/// long, up to the height [m] that `top` gives for the distance [m] from its rear.
SideView sideView(double yaw, double length, const std::function<double(double)>& top,
                  double spacing = 0.1) {
  SideView view;
  Rng rng(RngKey{5, 0, 0, 12});
  for (double u = 0; u <= length; u += spacing)
    for (double z = 0.3; z <= top(u); z += spacing) {
      view.places.push_back(Vector2(10, 5) + rotate2(yaw, {u, rng.normal(0, 0.02)}));
      view.above.push_back(z);
    }
  return view;
}

double sedan(double u) { return u < 0.8 ? 1.05 : u < 3 ? 1.45 : u < 3.4 ? 1.15 : 0.85; }
double hatchback(double u) { return u < 2.6 ? 1.5 : u < 3 ? 1.2 : 0.9; }
double box(double /*u*/) { return 1.5; }

TEST(FrontShape, IsTheEndTowardsWhichTheTopEdgeFalls) {
  for (const double yaw : {0.0, 0.7, -1.5, 3.0}) {
    EXPECT_GT(sideView(yaw, 4.4, sedan).logOdds(yaw), 2.2) << "more than 9 to 1";
    EXPECT_GT(sideView(yaw, 4.0, hatchback).logOdds(yaw), 2.2);
  }
}

TEST(FrontShape, TurnsItsSignWithTheAxisAndHasALimit) {
  const SideView view = sideView(0.7, 4.4, sedan);
  EXPECT_NEAR(view.logOdds(0.7), -view.logOdds(0.7 + kPi), 0.3);
  EXPECT_EQ(sideView(0, 4.2, [](double u) { return 2 - u / 3; }).logOdds(0), 3.5);
}

TEST(FrontShape, OfABoxIsOpen) { EXPECT_NEAR(sideView(0.3, 4.4, box).logOdds(0.3), 0, 0.1); }

TEST(FrontShape, IsNotToldByAPartOfACarOrByWhatIsLongerOrHigher) {
  EXPECT_EQ(sideView(0, 3, sedan).logOdds(0), 0);
  EXPECT_EQ(sideView(0, 7, sedan).logOdds(0), 0);
  EXPECT_EQ(sideView(0, 5, [](double u) { return u < 4 ? 3.0 : 1.5; }).logOdds(0), 0);
}

TEST(FrontShape, IsNotToldByFewReturnsOrWithoutTheMiddle) {
  EXPECT_EQ(sideView(0, 4.4, sedan, 0.4).logOdds(0), 0);
  SideView gap = sideView(0, 4.4, sedan), parts;
  for (std::size_t i = 0; i < gap.places.size(); ++i)
    if (gap.places[i].x() < 11.2 || gap.places[i].x() > 13) {
      parts.places.push_back(gap.places[i]);
      parts.above.push_back(gap.above[i]);
    }
  EXPECT_EQ(parts.logOdds(0), 0) << "as of two objects one behind the other";
}

}  // namespace
}  // namespace perception
