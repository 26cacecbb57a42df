#include "libperception/importers/bags/DoubledMessages.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

SensorFrame scanAt(std::int64_t ns, float x) {
  SensorFrame frame;
  frame.sensor = "LIDAR_TOP", frame.stamp = {ns};
  LidarCloud cloud;
  cloud.x = {x}, cloud.y = {0}, cloud.z = {1};
  frame.data = cloud;
  return frame;
}

TEST(DoubledMessages, TheSameContentAtTheSameStampIsADouble) {
  DoubledMessages doubles;
  EXPECT_FALSE(doubles.isDouble(scanAt(1, 5)));
  EXPECT_TRUE(doubles.isDouble(scanAt(1, 5)));
  EXPECT_FALSE(doubles.isDouble(scanAt(1, 6))) << "another part of the same turn";
  EXPECT_FALSE(doubles.isDouble(scanAt(2, 6))) << "the next scan of a world that stands";
  EXPECT_EQ(doubles.counts().at("LIDAR_TOP"), 1);
}

TEST(DoubledMessages, AScanWithAnotherStampIsADoubleBeforeTheLidarTurnsAgain) {
  DoubledMessages doubles;
  SensorFrame scan = scanAt(1'000'000'000, 5);
  auto& cloud = std::get<LidarCloud>(scan.data);
  cloud.x.resize(100, 7), cloud.y.resize(100, 7), cloud.z.resize(100, 7);
  EXPECT_FALSE(doubles.isDouble(scan, 0.02));
  scan.stamp = {1'005'000'000};
  EXPECT_TRUE(doubles.isDouble(scan, 0.02));
  scan.stamp = {1'050'000'000};
  EXPECT_FALSE(doubles.isDouble(scan, 0.02)) << "a simulated world that stands";
  EXPECT_EQ(doubles.counts().at("LIDAR_TOP"), 1);
}

TEST(DoubledMessages, SensorsAreAskedOneByOneAndImagesNever) {
  DoubledMessages doubles;
  SensorFrame other = scanAt(1, 5);
  other.sensor = "LIDAR_REAR";
  EXPECT_FALSE(doubles.isDouble(scanAt(1, 5)));
  EXPECT_FALSE(doubles.isDouble(other));
  other.data = CameraImage{};
  EXPECT_FALSE(doubles.isDouble(other));
  EXPECT_FALSE(doubles.isDouble(other));
  EXPECT_TRUE(doubles.counts().empty());
}

TEST(DoubledMessages, RadarScansAndBoxesAreComparedToo) {
  DoubledMessages doubles;
  SensorFrame radar = scanAt(1, 0), boxes = scanAt(1, 0);
  radar.sensor = "RADAR", boxes.sensor = "BOXES";
  RadarReturn target;
  target.range = 20;
  radar.data = RadarReturns{{target}, 0};
  ObjectDetections detections;
  detections.objects.resize(1);
  detections.objects[0].label = "Car";
  boxes.data = detections;
  for (SensorFrame* frame : {&radar, &boxes}) {
    EXPECT_FALSE(doubles.isDouble(*frame));
    EXPECT_TRUE(doubles.isDouble(*frame));
  }
  detections.objects[0].label = "Cyclist";
  boxes.data = detections;
  EXPECT_FALSE(doubles.isDouble(boxes));
}

}  // namespace
}  // namespace perception
