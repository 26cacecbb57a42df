#include "libperception/pipeline/health/FrozenPicture.h"

#include <gtest/gtest.h>

#include "tests/support/StartStamp.h"

namespace perception {
namespace {

using test::kStart;

template <class Data>
SensorFrame frameOf(double t, double x, Data data) {
  SensorFrame frame;
  frame.stamp = kStart + t;
  frame.ego.T_world_ego.translation().x() = x;
  frame.data = std::move(data);
  return frame;
}

RadarReturns targetAt(double range) {
  RadarReturns some;
  some.returns.resize(1);
  some.returns[0].range = range;
  return some;
}

TEST(FrozenPicture, TheSameTargetWhileTheVehicleDrivesIsNotTheWorld) {
  FrozenPicture picture;
  for (int k = 0; k <= 9; ++k) {
    picture.add(frameOf(0.1 * k, k, targetAt(20)));
    EXPECT_FALSE(picture.frozen());
  }
  for (int k = 10; k <= 12; ++k) picture.add(frameOf(0.1 * k, k, targetAt(20)));
  ASSERT_TRUE(picture.frozen());
  EXPECT_NEAR(picture.frozen()->seconds, 1.2, 1e-9);
  EXPECT_NEAR(picture.frozen()->meters, 12, 1e-9);
  picture.add(frameOf(1.3, 13, targetAt(21)));
  EXPECT_FALSE(picture.frozen());
}

TEST(FrozenPicture, AVehicleThatStandsMaySeeTheSameForLong) {
  FrozenPicture picture;
  for (int k = 0; k <= 100; ++k) picture.add(frameOf(0.1 * k, 0, targetAt(20)));
  EXPECT_FALSE(picture.frozen());
}

TEST(FrozenPicture, FramesOfNothingAndFramesThatAreSentTwiceAreNotFrozen) {
  FrozenPicture nothing, twice;
  for (int k = 0; k <= 40; ++k) {
    nothing.add(frameOf(0.1 * k, k, RadarReturns()));
    twice.add(frameOf(0.1 * k, k, targetAt(20 - 0.3 * (k / 2))));
    EXPECT_FALSE(nothing.frozen());
    EXPECT_FALSE(twice.frozen());
  }
}

TEST(FrozenPicture, CamerasAndLidarsFreezeToo) {
  ObjectDetections boxes;
  boxes.objects.resize(1);
  boxes.objects[0].image_box = ObjectDetection::ImageBox{10, 20, 30, 40};
  LidarCloud cloud;
  cloud.x = cloud.y = cloud.z = std::vector<float>(200, 5);
  FrozenPicture camera, lidar;
  for (int k = 0; k <= 12; ++k) {
    camera.add(frameOf(0.1 * k, k, boxes));
    lidar.add(frameOf(0.1 * k, k, cloud));
  }
  EXPECT_TRUE(camera.frozen());
  EXPECT_TRUE(lidar.frozen());
  boxes.objects[0].image_box->y2 = 41;
  cloud.y[61] = 6;
  camera.add(frameOf(1.3, 13, boxes));
  lidar.add(frameOf(1.3, 13, cloud));
  EXPECT_FALSE(camera.frozen());
  EXPECT_FALSE(lidar.frozen());
}

}  // namespace
}  // namespace perception
