#include <gtest/gtest.h>

#include <map>

#include "libperception/core/Csv.h"
#include "libperception/core/GroundTruth.h"
#include "tests/importers/ImportFixture.h"

// Single scans of KITTI's object benchmark as they were published.

namespace perception {
namespace {

using test::sharedData;

class KittiObjectScans : public test::ImportRun {};

TEST_F(KittiObjectScans, BoxesHoldThePublishedNumbersOfReturns) {
  NEEDS_SHARED_DATA("kitti_object_lidar");
  ASSERT_EQ(import("kitti-object", {"--dir", sharedData("kitti_object_lidar")}), 0) << error_;
  EXPECT_EQ(result_.scans, 14);
  for (const auto& [type, count] : std::map<std::string, std::uint64_t>{
           {"Car", 36}, {"Van", 12}, {"Truck", 5}, {"Pedestrian", 2}, {"Cyclist", 2}, {"Misc", 1}})
    EXPECT_EQ(result_.truth_types.at(type), count) << type;
  const auto scans = framesOf("LIDAR_TOP");
  const auto truth = readGroundTruth(file("out.truth.csv"));
  ASSERT_EQ(scans.size(), truth.instants.size());
  const CsvTable published = CsvTable::fromFile(sharedData("kitti_object_lidar/objects.csv"));
  std::size_t row = 0;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const auto& cloud = std::get<LidarCloud>(scans[k].data);
    EXPECT_GE(cloud.size(), 15187u);
    EXPECT_LE(cloud.size(), 20799u);
    const Pose3 T_sensor_world = scans[k].T_world_sensor().inverse();
    for (const TruthObject& o : truth.instants[k].objects) {
      if (o.type == "DontCare") continue;
      constexpr double kGrown = 0.1;  // [m] to every side, as published
      ObjectDetection::SpaceBox box{o.position, o.yaw, o.length + 2 * kGrown, o.width + 2 * kGrown,
                                    o.height + 2 * kGrown};
      box.bottom_center = T_sensor_world * (o.position - Vector3(0, 0, kGrown));
      box.yaw += yawOf(T_sensor_world);
      const int expected =
          static_cast<int>(published.integer(row++, published.column("points_in_box")));
      EXPECT_NEAR(returnsInside(box, cloud), expected, 3 + 0.05 * expected)
          << o.frame << " " << o.id;
      EXPECT_LE(o.lidar_points, expected + 1);
    }
  }
  EXPECT_EQ(row, 58u);
}

TEST_F(KittiObjectScans, EveryScanStartsItsOwnTracks) {
  NEEDS_SHARED_DATA("kitti_object_lidar");
  ASSERT_EQ(import("kitti-object", {"--dir", sharedData("kitti_object_lidar"), "--repeat", "10"}),
            0)
      << error_;
  const auto scenes = track("kitti_object.ini", "L");
  ASSERT_EQ(scenes.size(), 140u);
  std::map<std::uint64_t, std::size_t> scan_of;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    for (const auto& object : scenes[i].objects)
      EXPECT_EQ(scan_of.emplace(object.id, i / 10).first->second, i / 10) << object.id;
  }
  EXPECT_GE(scan_of.size(), 100u);
}

TEST_F(KittiObjectScans, AFolderWithImagesGivesThemAlong) {
  NEEDS_SHARED_DATA("kitti_object3");
  ASSERT_EQ(import("kitti-object", {"--dir", sharedData("kitti_object3")}), 0) << error_;
  EXPECT_EQ(result_.scans, 3);
  EXPECT_EQ(result_.images, 3);
  EXPECT_EQ(result_.truth_types.at("Car"), 2u);
  EXPECT_EQ(result_.truth_types.at("DontCare"), 4u);
}

}  // namespace
}  // namespace perception
