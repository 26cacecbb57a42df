#include "libperception/weather/Multipath.h"

#include <gtest/gtest.h>

#include "libperception/weather/PointFilter.h"

namespace perception {
namespace {

/// A car's rear 10 m ahead of a lidar at 1.8 m, and its image in the road.
SensorFrame carWithMirrorImage(bool car) {
  SensorFrame frame;
  frame.T_ego_sensor = makePose(0, 0, 1.8, 0);
  frame.ground.measured = true;
  LidarCloud cloud;
  const auto add = [&cloud](double x, double y, double above) {
    cloud.x.push_back(static_cast<float>(x)), cloud.y.push_back(static_cast<float>(y));
    cloud.z.push_back(static_cast<float>(above - 1.8));
  };
  for (int k = 0; k < 40; ++k) {
    const double y = -0.8 + 0.04 * k;
    add(10, y, -0.7 - 0.02 * k);          // the image
    if (car) add(10, y, 0.7 + 0.02 * k);  // what it is of
    add(6, y, 0);
  }
  frame.data = std::move(cloud);
  return frame;
}

TEST(Multipath, FindsTheImageOfACarInAWetRoad) {
  const SensorFrame frame = carWithMirrorImage(true);
  const auto found = findMirrorImages(frame, {});
  ASSERT_EQ(found.size(), 40U);
  for (const std::uint32_t i : found) EXPECT_LT(std::get<LidarCloud>(frame.data).z[i], -1.8 - 0.3);
}

TEST(Multipath, HoleInTheRoadIsNoImage) {
  EXPECT_TRUE(findMirrorImages(carWithMirrorImage(false), {}).empty());
}

TEST(Multipath, NeedsAMeasuredGround) {
  SensorFrame frame = carWithMirrorImage(true);
  frame.ground.measured = false;
  EXPECT_TRUE(findMirrorImages(frame, {}).empty());
}

TEST(Multipath, PhantomsHaveNoImages) {
  SensorFrame frame = carWithMirrorImage(true);
  auto& cloud = std::get<LidarCloud>(frame.data);
  cloud.trust.assign(cloud.size(), 0);
  EXPECT_TRUE(findMirrorImages(frame, {}).empty());
}

TEST(Multipath, TiltedGroundIsMirroredAboutItself) {
  SensorFrame frame = carWithMirrorImage(true);
  auto& cloud = std::get<LidarCloud>(frame.data);
  frame.ground.a = 0.05;
  for (std::size_t i = 0; i < cloud.size(); ++i) cloud.z[i] += 0.05F * cloud.x[i];
  EXPECT_EQ(findMirrorImages(frame, {}).size(), 40U);
}

TEST(Multipath, FilterTakesTrustFromMirrorImages) {
  WeatherParams params;
  params.filter = "trust";
  SensorFrame frame = carWithMirrorImage(true);
  const TrustStats stats = makePointFilter(params)->apply(frame);
  EXPECT_GE(stats.mirrored, 30U);
}

}  // namespace
}  // namespace perception
