#include "libperception/pipeline/health/StandingReturns.h"

#include <gtest/gtest.h>

#include "tests/support/StartStamp.h"

namespace perception {
namespace {

using test::kStart;

TEST(StandingReturns, AWallIsThereWhereverTheVehicleIsAndTheRoadIsNot) {
  SensorFrame frame;
  frame.stamp = kStart;
  frame.T_ego_sensor.translation().z() = 2;
  frame.ego.T_world_ego.translation() << 1000, -500, 30;
  frame.ego.T_world_ego.linear() = Eigen::AngleAxisd(radians(90), Vector3::UnitZ()).matrix();
  frame.ground.a = 0.03;  // rises ahead
  LidarCloud cloud;       // a wall 20 m ahead, the road 50 m ahead
  cloud.x = {20, 50};
  cloud.y = {0, 0};
  cloud.z = {-0.5F, -0.4F};
  StandingReturns standing;
  EXPECT_FALSE(standing.at({1000, -480}, kStart));
  standing.add(frame, cloud);
  EXPECT_TRUE(standing.at({1000, -480}, kStart));
  EXPECT_TRUE(standing.at({1001, -479.5}, kStart));
  EXPECT_FALSE(standing.at({1000, -450}, kStart));
  EXPECT_FALSE(standing.at({1004, -480}, kStart));
  EXPECT_FALSE(standing.at({0, 0}, kStart));
  EXPECT_FALSE(standing.at({1000, -480}, kStart + 1.0)) << "nothing is known of it now";
  standing.add(frame, LidarCloud());
  EXPECT_FALSE(standing.at({1000, -480}, kStart));
}

}  // namespace
}  // namespace perception
