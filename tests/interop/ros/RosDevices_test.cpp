#include "libperception/interop/ros/RosDevices.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "libperception/core/math/Angle.h"
#include "libperception/interop/ros/RosSensors.h"

namespace perception::ros {
namespace {

/// Ranges at -90, 0, 90 and 180 degrees.
LaserScan quarters() {
  LaserScan scan;
  scan.header = {Stamp::fromSeconds(1'500'000'000), "bumper"};
  scan.angle_increment = static_cast<float>(kPi / 2);
  scan.angle_min = -scan.angle_increment, scan.angle_max = 2 * scan.angle_increment;
  scan.range_min = 0.5F, scan.range_max = 30;
  scan.time_increment = 0.01F;
  scan.ranges = {10, 20, 5, 8};
  scan.intensities = {10, 20, 30, 40};
  return scan;
}

TEST(RosDevices, ALaserScanIsAPlaneCounterClockwiseFromItsFirstAngle) {
  const LidarCloud cloud = cloudOf(quarters(), 100);
  ASSERT_EQ(cloud.size(), 4U);
  const double x[] = {0, 20, 0, -8}, y[] = {-10, 0, 5, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(cloud.x[i], x[i], 1e-5);
    EXPECT_NEAR(cloud.y[i], y[i], 1e-5);
    EXPECT_EQ(cloud.z[i], 0);
    EXPECT_NEAR(cloud.intensity[i], 0.1 * static_cast<double>(i + 1), 1e-6);
    EXPECT_NEAR(cloud.time_offset[i], 0.01 * static_cast<double>(i), 1e-6);
  }
  EXPECT_EQ(cloud.max_range, 30);
}

TEST(RosDevices, RangesThatAreNoReturnsAreLeftOut) {
  LaserScan scan = quarters();
  scan.ranges = {std::numeric_limits<float>::infinity(), std::nanf(""), 0.4F, 30.5F};
  EXPECT_EQ(cloudOf(scan).size(), 0U);
  scan.ranges[2] = 3;
  const LidarCloud cloud = cloudOf(scan);
  ASSERT_EQ(cloud.size(), 1U);
  EXPECT_NEAR(cloud.y[0], 3, 1e-5);
  EXPECT_EQ(cloud.intensity, std::vector<float>{30}) << "of the same range";
  EXPECT_NEAR(cloud.time_offset[0], 0.02, 1e-6);
  scan.intensities.clear(), scan.time_increment = 0;
  EXPECT_TRUE(cloudOf(scan).intensity.empty());
  EXPECT_TRUE(cloudOf(scan).time_offset.empty());
}

TEST(RosDevices, ALaserScanThatContradictsItselfIsRefused) {
  LaserScan scan = quarters();
  scan.intensities.pop_back();
  EXPECT_THROW(cloudOf(scan), std::runtime_error);
  scan = quarters();
  scan.angle_increment = std::nanf("");
  EXPECT_THROW(cloudOf(scan), std::runtime_error);
}

TEST(RosDevices, ALaserScanComesBackFromBothEncodings) {
  for (const Encoding encoding : {Encoding::kCdr, Encoding::kRos1}) {
    LaserScan scan = quarters();
    const auto back = decoded<LaserScan>(encoded(scan, encoding), encoding);
    EXPECT_EQ(back.header.frame_id, "bumper");
    EXPECT_EQ(back.ranges, scan.ranges);
    EXPECT_EQ(back.intensities, scan.intensities);
    EXPECT_EQ(back.range_max, 30);
  }
}

}  // namespace
}  // namespace perception::ros
