#include "libperception/simulation/world/Trajectory.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

TEST(Trajectory, PassesItsWaypoints) {
  const std::vector<double> t = {0, 2, 3, 7}, x = {0, 4, 5, 5}, y = {1, 1, -2, -9};
  const Trajectory way(t, x, y, 0);
  for (std::size_t i = 0; i < t.size(); ++i) {
    EXPECT_NEAR(way.at(t[i]).position.x(), x[i], 1e-12);
    EXPECT_NEAR(way.at(t[i]).position.y(), y[i], 1e-12);
  }
}

TEST(Trajectory, VelocityIsTheDerivativeOfThePosition) {
  const Trajectory way({0, 2, 3, 7, 8}, {0, 4, 5, 5, 9}, {1, 1, -2, -9, -9}, 0);
  constexpr double kStep = 1e-5;
  for (double t = 0.013; t < 8; t += 0.1) {
    const Vector2 difference =
        (way.at(t + kStep).position - way.at(t - kStep).position) / (2 * kStep);
    EXPECT_LT((way.at(t).velocity - difference).norm(), 1e-4) << t;
  }
}

TEST(Trajectory, YawRateIsTheDerivativeOfTheHeading) {
  const Trajectory way({0, 2, 4, 6}, {0, 10, 17, 20}, {0, 0, 3, 10}, 0);
  constexpr double kStep = 1e-5;
  for (double t = 0.5; t < 5.5; t += 0.13) {
    const double difference = wrapAngle(way.at(t + kStep).heading - way.at(t - kStep).heading);
    EXPECT_NEAR(way.at(t).yaw_rate, difference / (2 * kStep), 1e-3) << t;
  }
}

TEST(Trajectory, SamePlaceTwiceIsAPauseWithoutOvershoot) {
  const Trajectory way({0, 3, 6, 9}, {0, 10, 10, 20}, {0, 0, 0, 0}, 0);
  for (double t = 0; t <= 9; t += 0.01) {
    const double x = way.at(t).position.x();
    if (t < 3) {
      EXPECT_LE(x, 10) << t;
    } else if (t <= 6) {
      EXPECT_EQ(x, 10) << t;
      EXPECT_EQ(way.at(t).velocity.norm(), 0) << t;
    } else {
      EXPECT_GE(x, 10) << t;
    }
  }
}

TEST(Trajectory, KeepsItsHeadingAtRest) {
  const Trajectory way({0, 2, 4, 6}, {0, 0, 0, -8}, {0, 6, 6, 6}, 0);
  EXPECT_NEAR(way.at(3).heading, kPi / 2, 1e-9);
  EXPECT_NEAR(wrapAngle(way.at(6).heading - kPi), 0, 1e-9);
  const Trajectory late({5, 6}, {0, -1}, {0, -1}, 0);
  EXPECT_NEAR(late.at(0).heading, -3 * kPi / 4, 1e-9) << "before the first motion: the first one's";
  const Trajectory parked({0}, {1}, {2}, 0.7);
  EXPECT_EQ(parked.at(3).heading, 0.7);
}

TEST(Trajectory, TraveledIsTheLengthOfTheWay) {
  const Trajectory way({0, 1, 2, 3}, {0, 3, 6, 9}, {0, 4, 8, 12}, 0);
  EXPECT_NEAR(way.at(3).traveled, 15, 0.05);
  EXPECT_NEAR(way.at(1).traveled, 5, 0.05);
}

TEST(Trajectory, NamesWhatIsWrong) {
  EXPECT_EQ(Trajectory::fault({0, 1}, {0, 1}, {0, 1}), "");
  EXPECT_NE(Trajectory::fault({}, {}, {}).find("at least one waypoint"), std::string::npos);
  EXPECT_NE(Trajectory::fault({0, 1}, {0}, {0, 1}).find("as many"), std::string::npos);
  EXPECT_NE(Trajectory::fault({0, 1, 1}, {0, 1, 2}, {0, 0, 0}).find("increasing"),
            std::string::npos);
  EXPECT_NE(Trajectory::fault({0, 1}, {0, 900}, {0, 0}).find("900 m/s"), std::string::npos);
}

}  // namespace
}  // namespace perception
