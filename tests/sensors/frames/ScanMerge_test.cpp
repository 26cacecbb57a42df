#include "libperception/sensors/frames/ScanMerge.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

constexpr Stamp kStart{1'317'038'400'000'000'000};

SensorFrame scan(const std::string& label, double t, const Pose3& pose, std::vector<float> x) {
  SensorFrame frame;
  frame.sensor = label;
  frame.stamp = kStart + t;
  frame.T_ego_sensor = pose;
  LidarCloud cloud;
  cloud.y.assign(x.size(), 0);
  cloud.z.assign(x.size(), 0);
  cloud.x = std::move(x);
  frame.data = cloud;
  return frame;
}

TEST(ScanParams, StarStandsForAnyEnd) {
  ScanParams params;
  params.merge = {"IBEO_CENTER", "IBEO_LEFT_L*"};
  EXPECT_TRUE(params.merges("IBEO_CENTER"));
  EXPECT_TRUE(params.merges("IBEO_LEFT_L0"));
  EXPECT_FALSE(params.merges("IBEO_LEFT"));
  EXPECT_FALSE(params.merges("IBEO_CENTER_2"));
  EXPECT_FALSE(ScanParams().merges("LIDAR_TOP"));
}

TEST(MergedScan, PointsKeepTheirPlaceOnTheVehicle) {
  const auto a = scan("A", 0, makePose(4, 0, 0.6, 0), {10, 20});
  const auto b = scan("B", 0, makePose(3.8, 0.8, 0.6, radians(40), 0.01), {5});
  const SensorFrame merged = mergedScan({a, b}, "AB");
  EXPECT_EQ(merged.sensor, "AB");
  const auto& cloud = std::get<LidarCloud>(merged.data);
  ASSERT_EQ(cloud.size(), 3U);
  const Vector3 on_vehicle = merged.T_ego_sensor * Vector3(cloud.x[2], cloud.y[2], cloud.z[2]);
  EXPECT_LT((on_vehicle - b.T_ego_sensor * Vector3(5, 0, 0)).norm(), 1e-5);
  EXPECT_EQ(cloud.ring, (std::vector<std::uint16_t>{0, 0, 1}));
  EXPECT_TRUE(cloud.time_offset.empty());  // of one instant
}

TEST(MergedScan, TimesAreWithTheNewestScan) {
  auto a = scan("A", 0, Pose3::Identity(), {10, 20});
  std::get<LidarCloud>(a.data).time_offset = {0, 0.01F};
  const auto b = scan("B", 0.03, Pose3::Identity(), {5});
  const SensorFrame merged = mergedScan({a, b}, "AB");
  EXPECT_EQ(merged.stamp.ns, (kStart + 0.03).ns);
  const auto& times = std::get<LidarCloud>(merged.data).time_offset;
  ASSERT_EQ(times.size(), 3U);
  EXPECT_NEAR(times[0], -0.03, 1e-6);
  EXPECT_NEAR(times[1], -0.02, 1e-6);
  EXPECT_NEAR(times[2], 0, 1e-6);
}

TEST(MergedScan, LabelsOfOneScannerDoNotLabelTheOther) {
  auto a = scan("A", 0, Pose3::Identity(), {10, 20});
  auto b = scan("B", 0, Pose3::Identity(), {5, 6});
  std::get<LidarCloud>(b.data).label = {1, 3};
  std::get<LidarCloud>(b.data).ring = {2, 3};
  const auto merged = mergedScan({a, b, a}, "ABA");
  const auto& cloud = std::get<LidarCloud>(merged.data);
  EXPECT_EQ(cloud.label, (std::vector<std::uint8_t>{0, 0, 1, 3, 0, 0}));
  EXPECT_EQ(cloud.ring, (std::vector<std::uint16_t>{0, 0, 3, 4, 5, 5}));
  EXPECT_TRUE(cloud.intensity.empty());
}

}  // namespace
}  // namespace perception
