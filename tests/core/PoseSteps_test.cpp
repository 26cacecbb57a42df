#include "libperception/core/PoseSteps.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

TEST(PoseSteps, AShareOfAStraightWayAndOfATurn) {
  const Pose3 a = makePose(1, 2, 3, 0.5), b = makePose(3, 2, 7, 0.9);
  EXPECT_TRUE(interpolate(a, b, 0).isApprox(a));
  EXPECT_TRUE(interpolate(a, b, 1).isApprox(b));
  EXPECT_TRUE(interpolate(a, b, 0.25).isApprox(makePose(1.5, 2, 4, 0.6)));
  EXPECT_TRUE(interpolate(a, b, -0.5).isApprox(makePose(0, 2, 1, 0.3)));
}

TEST(PoseSteps, TurnIsAngleTimesAxis) {
  EXPECT_TRUE(turnOf(makePose(1, 2, 3, -0.4)).isApprox(Vector3(0, 0, -0.4)));
  EXPECT_TRUE(turnOf(makePose(0, 0, 0, 0, 0.2)).isApprox(Vector3(0, 0.2, 0)));
  EXPECT_TRUE(turnOf(Pose3::Identity()).isZero());
}

}  // namespace
}  // namespace perception
