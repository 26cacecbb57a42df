#include "libperception/filter/update/LanePrior.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/LogMath.h"
#include "libperception/filter/state/ClassFilterMotion.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

/// A car on a lane that leads east, between two of its own kind that lead west and both ways.
struct Street {
  FilterModel model = test::exactModel(test::linearClasses());
  LaneParams params;

  Street() { model.classes.classes[0].motion = findMotionModel("wheeled"); }
  LanePrior lanes() const {
    return LanePrior(LaneMap({{"east", {{-100, 0}, {100, 0}}, 4, true},
                              {"any", {{-100, 20}, {100, 20}}, 4, false},
                              {"cross", {{50, -50}, {50, 50}}, 4, true}}),
                     params);
  }
  static Track car(const Vector2& place, double speed, double yaw, double sigma_yaw) {
    Track t;
    t.bank.resize(2);
    t.log_class = {std::log(0.9), std::log(0.1)};
    t.stamp = Stamp::fromSeconds(1000);
    ClassFilter& f = t.bank[0];
    f.x << place.x(), place.y(), speed, yaw;
    f.P = Matrix4::Identity() * 0.1;
    f.P(3, 3) = sigma_yaw * sigma_yaw;
    f.oriented = true;
    return t;
  }
};

TEST(LanePrior, PullsTheHeadingByTheStatedVariance) {
  const Street s;
  Track t = Street::car({0, 1}, 5, 0.2, 0.1);
  s.lanes().apply(s.model, t);
  const double gain = 0.01 / (0.01 + s.params.sigma * s.params.sigma);
  EXPECT_NEAR(t.bank[0].x[3], 0.2 * (1 - gain), 1e-12);
  EXPECT_NEAR(t.bank[0].P(3, 3), 0.01 * (1 - gain), 1e-12);
  EXPECT_NEAR(t.bank[0].heading.log_odds, logit(s.params.forward), 1e-12);
  EXPECT_EQ(t.bank[1].x, Vector4(Vector4::Zero())) << "what stands has no heading";
}

TEST(LanePrior, SpeaksOncePerIntervalAndOfFrontAndBackOnce) {
  const Street s;
  const LanePrior lanes = s.lanes();
  Track t = Street::car({0, 1}, 5, 0.2, 0.1);
  lanes.apply(s.model, t);
  const Track first = t;
  t.stamp = t.stamp + 0.9;
  lanes.apply(s.model, t);
  EXPECT_EQ(t.bank[0].x, first.bank[0].x);
  t.stamp = t.stamp + 0.2;
  lanes.apply(s.model, t);
  EXPECT_LT(t.bank[0].x[3], first.bank[0].x[3]);
  EXPECT_EQ(t.bank[0].heading.log_odds, first.bank[0].heading.log_odds);
}

TEST(LanePrior, TurnsAStandingCarThatFacesTheWrongWay) {
  const Street s;
  Track t = Street::car({0, 1}, 0.1, kPi - 0.05, 0.1);
  s.lanes().apply(s.model, t);
  EXPECT_LT(std::abs(t.bank[0].x[3]), 0.1);
  EXPECT_NEAR(t.bank[0].x[2], -0.1, 1e-12);
}

TEST(LanePrior, DoesNotMakeAFastCarDriveBackwards) {
  const Street s;
  const LanePrior lanes = s.lanes();
  Track t = Street::car({0, 1}, 8, kPi, 0.1);
  for (int k = 0; k < 20; ++k) {
    lanes.apply(s.model, t);
    t.stamp = t.stamp + 1.1;
  }
  EXPECT_EQ(t.bank[0].x[2], 8);
}

TEST(LanePrior, GivesAStandingCarWithoutHeadingThatOfItsLane) {
  const Street s;
  Track t = Street::car({0, -20}, 0, 0, 0.1);
  t.bank[0].oriented = false;
  t.bank[0].x.tail<2>() << 0.2, 0.1;
  const Track before = t;
  s.lanes().apply(s.model, t);
  EXPECT_FALSE(t.bank[0].oriented) << "no lane here";
  t.bank[0].x[1] = 0;
  s.lanes().apply(s.model, t);
  ASSERT_TRUE(t.bank[0].oriented);
  EXPECT_EQ(t.bank[0].x[3], 0);
  t = before;
  t.bank[0].x.head<2>() << 50, 0;
  s.lanes().apply(s.model, t);
  EXPECT_FALSE(t.bank[0].oriented) << "where lanes cross they say nothing";
}

TEST(LanePrior, LeavesAloneWhoTurnsOrCrosses) {
  const Street s;
  Track t = Street::car({0, 1}, 5, 1.2, 0.1);
  s.lanes().apply(s.model, t);
  EXPECT_EQ(t.bank[0].x[3], 1.2);
  EXPECT_EQ(t.last_lane.ns, 0);
}

TEST(LanePrior, SaysNothingOfWhatIsHardlyWheeled) {
  const Street s;
  Track t = Street::car({0, 1}, 5, 0.2, 0.1);
  t.log_class = {std::log(0.4), std::log(0.6)};
  s.lanes().apply(s.model, t);
  EXPECT_EQ(t.bank[0].x[3], 0.2);
}

TEST(LanePrior, ALaneOfBothWaysTellsTheAxisAlone) {
  const Street s;
  Track t = Street::car({0, 20}, 0.1, kPi - 0.2, 0.1);
  s.lanes().apply(s.model, t);
  EXPECT_GT(t.bank[0].x[3], kPi - 0.2);
  EXPECT_EQ(t.bank[0].heading.log_odds, 0);
}

}  // namespace
}  // namespace perception
