#include "libperception/measurement/frames/LidarInputs.h"

#include <gtest/gtest.h>

#include <cmath>

namespace perception {
namespace {

/// A sweep of 900 returns at 10 m.
LidarCloud sweep() {
  LidarCloud cloud;
  for (int i = 0; i < 900; ++i) {
    const float azimuth = static_cast<float>(i) * 0.007f;
    cloud.x.push_back(10 * std::cos(azimuth)), cloud.y.push_back(10 * std::sin(azimuth));
    cloud.z.push_back(0);
    cloud.intensity.push_back(static_cast<float>(i % 200) / 255);
  }
  return cloud;
}

IntensityKind kindIn(std::size_t values, float scale) {
  LidarCloud cloud = sweep();
  for (std::size_t i = 0; i < cloud.size(); ++i)
    cloud.intensity[i] = scale * static_cast<float>(i % values);
  return intensityKindOf(cloud);
}

TEST(LidarInputs, IntensitiesOfAnyScaleAreUsable) {
  for (const float scale : {1 / 255.f, 1.f, 257.f})
    EXPECT_EQ(kindIn(100, scale), IntensityKind::kUsable);
}

TEST(LidarInputs, OneValueForAllReturnsRanksNothing) {
  for (const float value : {0.f, 0.3f, 255.f}) {
    LidarCloud cloud = sweep();
    cloud.intensity.assign(cloud.size(), value);
    EXPECT_EQ(intensityKindOf(cloud), IntensityKind::kFlat);
  }
  LidarCloud none = sweep();
  none.intensity.clear();
  EXPECT_EQ(intensityKindOf(none), IntensityKind::kNone);
}

TEST(LidarInputs, AHandfulOfValuesIsNamed) {
  EXPECT_EQ(kindIn(5, 0.25f), IntensityKind::kSteps);
  EXPECT_EQ(kindIn(16, 1), IntensityKind::kUsable);
}

TEST(LidarInputs, SayWhatIsMissing) {
  LidarCloud cloud = sweep();
  EXPECT_EQ(LidarInputs::of(cloud).missing(), "no numbers of beams, no times of returns");
  cloud.ring.assign(cloud.size(), 15);
  cloud.time_offset.assign(cloud.size(), 0);
  EXPECT_EQ(LidarInputs::of(cloud).missing(), "");
  EXPECT_EQ(LidarInputs::of(cloud).beams, 16);
  cloud.intensity.clear();
  EXPECT_EQ(LidarInputs::of(cloud).missing(), "no intensity");
}

TEST(LidarInputs, ReturnsInNoOrderAreTold) {
  LidarCloud cloud = sweep();
  EXPECT_TRUE(LidarInputs::of(cloud).ordered);
  for (std::size_t i = 0; i < cloud.size(); i += 2) {
    cloud.x[i] = -cloud.x[i], cloud.y[i] = -cloud.y[i];
  }
  EXPECT_FALSE(LidarInputs::of(cloud).ordered);
}

}  // namespace
}  // namespace perception
