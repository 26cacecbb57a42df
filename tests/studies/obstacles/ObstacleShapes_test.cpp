#include "studies/obstacles/ObstacleShapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "libperception/core/Frames.h"
#include "libperception/core/math/Angle.h"
#include "libperception/grid/way/StopAdvice.h"
#include "libperception/lidar/LidarFrontEnd.h"

namespace perception {
namespace {

/// [m] from the lane's middle to the nearest part of a box, by its corners and its middle line.
double asideOf(const ShapeBox& box) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double a : {-0.5, 0.5})
    for (const double b : {-0.5, 0.5}) {
      const Vector2 corner = rotate2(radians(box.yaw_deg), Vector2(a * box.length, b * box.width));
      low = std::min(low, box.y + corner.y()), high = std::max(high, box.y + corner.y());
    }
  return low <= 0 && high >= 0 ? 0 : std::min(std::abs(low), std::abs(high));
}

TEST(ObstacleShapes, AreSixtyAndMoreWithNamesOfTheirOwn) {
  std::set<std::string> names, kinds;
  std::size_t to_stop_for = 0;
  for (const ObstacleShape& shape : obstacleShapes()) {
    EXPECT_TRUE(names.insert(shape.name).second) << shape.name;
    kinds.insert(shape.kind);
    to_stop_for += shape.demand == ShapeDemand::kStop;
  }
  EXPECT_GE(to_stop_for, 60u);
  EXPECT_GE(kinds.size(), 8u);
}

TEST(ObstacleShapes, HaveTheSizesOfThings) {
  for (const ObstacleShape& shape : obstacleShapes()) {
    for (const ShapeBox& box : shape.boxes) {
      for (const double edge : {box.length, box.width, box.height}) {
        EXPECT_GE(edge, 0.01) << shape.name;
        EXPECT_LE(edge, 30) << shape.name;
      }
      EXPECT_GE(box.base, 0) << shape.name;
      EXPECT_LE(box.base + box.height, 8) << shape.name;
      EXPECT_GE(box.reflectivity, 0.1) << shape.name;
      EXPECT_LE(0.4 * box.reflectivity, 0.9) << shape.name;
    }
  }
}

TEST(ObstacleShapes, ThatAreLowEndBelowTheObstaclesOfAFrontEnd) {
  const double least = ObstacleParams{}.height_min;
  for (const ObstacleShape& shape : obstacleShapes()) {
    if (shape.demand == ShapeDemand::kPass) continue;
    EXPECT_EQ(topOf(shape) <= least, shape.demand == ShapeDemand::kLow) << shape.name;
  }
}

TEST(ObstacleShapes, AreInTheWayWhereTheVehicleNeedsRoom) {
  constexpr double kRoof = 1.73;  // [m]
  const double half = 0.5 * StopParams{}.width, room = kRoof + StopParams{}.clearance;
  for (const ObstacleShape& shape : obstacleShapes()) {
    const bool in_the_way =
        std::any_of(shape.boxes.begin(), shape.boxes.end(),
                    [&](const ShapeBox& box) { return box.base < room && asideOf(box) < half; });
    EXPECT_EQ(in_the_way, shape.demand != ShapeDemand::kPass) << shape.name;
  }
}

}  // namespace
}  // namespace perception
