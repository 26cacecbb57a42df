#include "libperception/simulation/weather/sensors/FalseBoxes.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

/// Precision of a detector of precision `sunny` after rain of `wetness`, all of one label.
double precision(const std::string& label, double sunny, double wetness) {
  constexpr int kRight = 20000;
  SensorFrame frame;
  ObjectDetections boxes;
  boxes.camera.width = 1242, boxes.camera.height = 375;
  ObjectDetection d;
  d.label = label;
  d.image_box = {600, 150, 640, 200};
  boxes.objects.assign(kRight, d);
  frame.data = boxes;
  Rng rng({1, 0, 0, 0});
  addFalseBoxes(wetness, frame, rng);
  const auto& all = std::get<ObjectDetections>(frame.data).objects;
  for (const auto& wrong : all) {
    EXPECT_GE(wrong.image_box->x1, 0);
    EXPECT_LE(wrong.image_box->x2, 1242);
    EXPECT_LE(wrong.image_box->y2, 374);
    EXPECT_EQ(wrong.label, label);
  }
  return kRight / (static_cast<double>(all.size()) + kRight * (1 / sunny - 1));
}

TEST(FalseBoxes, PrecisionFallsAsMeasuredFromSunToRain) {
  EXPECT_NEAR(precision("Car", .95, 1), .93, .005);
  EXPECT_NEAR(precision("Pedestrian", .90, 1), .76, .01);
  EXPECT_NEAR(precision("Pedestrian", .90, 0), .90, 1e-9);
}

TEST(FalseBoxes, LeavesOtherFramesAlone) {
  SensorFrame frame;
  frame.data = RadarReturns{};
  Rng rng({1, 0, 0, 0});
  addFalseBoxes(1, frame, rng);
  EXPECT_TRUE(std::holds_alternative<RadarReturns>(frame.data));
}

}  // namespace
}  // namespace perception
