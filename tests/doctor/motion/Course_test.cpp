#include "libperception/doctor/motion/Course.h"

#include <gtest/gtest.h>

#include "tests/doctor/TestDrive.h"

namespace perception {
namespace {

using test::stampAt;

EgoState egoAt(double t, const Pose3& pose) {
  EgoState state;
  state.stamp = stampAt(t), state.T_world_ego = pose;
  return state;
}

TEST(Course, GoesThroughThePosesInOrderOfTimeAndNotBeyondThem) {
  const Course course({egoAt(1, makePose(4, 0, 0, 0.2)), egoAt(0.5, makePose(2, 0, 0, 0)),
                       egoAt(1, makePose(9, 9, 9, 0))});
  ASSERT_TRUE(course.at(stampAt(0.5), 0.125) && course.at(stampAt(1), 0));
  EXPECT_TRUE(course.at(stampAt(0.5), 0.125)->isApprox(makePose(2.5, 0, 0, 0.05)));
  EXPECT_TRUE(course.at(stampAt(1), 0)->isApprox(makePose(4, 0, 0, 0.2)));
  EXPECT_FALSE(course.at(stampAt(0.4), 0) || course.at(stampAt(1), 0.1));
}

TEST(Course, IsUnknownBetweenPosesMoreThanASecondApart) {
  const Course course({egoAt(0, Pose3::Identity()), egoAt(1.1, Pose3::Identity())});
  EXPECT_FALSE(course.at(stampAt(0.5), 0));
  EXPECT_TRUE(course.at(stampAt(1.1), 0));
}

TEST(Course, MotionIsInTheFrameOfItsStart) {
  const Course course({egoAt(0, makePose(5, 5, 0, kPi / 2)), egoAt(0.5, makePose(5, 7, 0, kPi))});
  const auto motion = course.motion(stampAt(0), stampAt(0.5), 0);
  ASSERT_TRUE(motion);
  EXPECT_TRUE(motion->isApprox(makePose(2, 0, 0, kPi / 2)));
  EXPECT_FALSE(course.motion(stampAt(0), stampAt(0.5), 0.1));
}

}  // namespace
}  // namespace perception
