#include "libperception/simulation/lidar/PointTruth.h"

#include <gtest/gtest.h>

#include "tests/simulation/SceneText.h"

namespace perception {
namespace {

using test::kRoofLidar, test::kStanding, test::parked, test::scenarioOf;

TEST(PointTruth, NamesSurfacesAndPhantoms) {
  const Scenario scenario = scenarioOf(kStanding + kRoofLidar + parked("car", "car", 9, 0) +
                                       parked("man", "pedestrian", 9, 5));
  LidarSensor::Scan scan;
  scan.surfaces = {0, 1, BeamHit::kRoad, 0, BeamHit::kNothing};
  EXPECT_EQ(pointLabels(scan, scenario), (std::vector<std::uint32_t>{10, 30, 40, 10, 40}));
  scan.phantoms = {Phantom::kNone, Phantom::kNone, Phantom::kMirror, Phantom::kSnow,
                   Phantom::kRain};
  EXPECT_EQ(pointLabels(scan, scenario), (std::vector<std::uint32_t>{10, 30, 116, 110, 112}));
}

TEST(PointTruth, ExistsForOneScanAFrame) {
  EXPECT_TRUE(hasPointLabels(scenarioOf(kStanding + kRoofLidar)));
  EXPECT_FALSE(hasPointLabels(scenarioOf(kStanding + kRoofLidar + "rate = 12.5\n")));
  EXPECT_FALSE(hasPointLabels(
      scenarioOf(kStanding + kRoofLidar + "[sensor.IBEO]\nkind = lidar4\nrate = 10\n")));
}

TEST(PointTruth, FilesAreNumberedByFrame) {
  EXPECT_EQ(labelFileName(7), "000007.label");
  EXPECT_EQ(labelBytes({110, 1}), std::string("\x6e\0\0\0\x01\0\0\0", 8));
}

}  // namespace
}  // namespace perception
