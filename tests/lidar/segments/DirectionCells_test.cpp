#include "libperception/lidar/segments/DirectionCells.h"

#include <gtest/gtest.h>

#include <cmath>

namespace perception {
namespace {

struct Direction {
  double azimuth, elevation;  ///< [rad]
};

EgoPoints pointsAt(const std::vector<std::pair<Direction, double>>& list,
                   const Vector3& sensor = Vector3::Zero()) {
  EgoPoints points;
  points.sensor = sensor;
  for (const auto& [d, range] : list) {
    const double flat = range * std::cos(d.elevation);
    points.x.push_back(static_cast<float>(sensor.x() + flat * std::cos(d.azimuth)));
    points.y.push_back(static_cast<float>(sensor.y() + flat * std::sin(d.azimuth)));
    points.z.push_back(static_cast<float>(sensor.z() + range * std::sin(d.elevation)));
    points.source.push_back(static_cast<std::uint32_t>(points.source.size()));
  }
  return points;
}

DirectionCells::Place placeOf(const Direction& d) {
  return DirectionCells(pointsAt({{d, 7}})).placeOf(0);
}

TEST(DirectionCells, PlacesAreStepsOfAzimuthAndElevation) {
  for (const double degree : {0.2, 30.2, 89.8, 90.2, 179.8, 180.2, 270.2, 359.8}) {
    const auto p = placeOf({radians(degree), radians(-10.2)});
    EXPECT_EQ(p.column, static_cast<int>(degree / 0.4)) << degree;
    EXPECT_EQ(p.row, static_cast<int>((30 - 10.2) / 0.4));
  }
}

TEST(DirectionCells, ElevationsBeyondTheRowsAreInTheOutermost) {
  EXPECT_EQ(placeOf({1, radians(-50)}).row, 0);
  EXPECT_EQ(placeOf({1, radians(50)}).row, DirectionCells::kRows - 1);
}

TEST(DirectionCells, KeepTheNearestAndTheFarthestRange) {
  const Direction d{radians(20.2), radians(-3.8)};
  const Vector3 sensor(1, -2, 1.7);
  const DirectionCells cells(pointsAt({{d, 12}, {d, 30}, {d, 5}}, sensor));
  const auto p = placeOf(d);
  EXPECT_NEAR(cells.at(p.column, p.row).nearest, 5, 1e-4);
  EXPECT_NEAR(cells.at(p.column, p.row).farthest, 30, 1e-4);
  EXPECT_FALSE(cells.at(p.column, p.row).empty());
  EXPECT_TRUE(cells.at(p.column + 1, p.row).empty());
  EXPECT_EQ(cells.at(p.column + 1, p.row).nearest, std::numeric_limits<float>::infinity());
}

TEST(DirectionCells, ColumnsWrapAroundAndRowsDoNot) {
  const Direction last{radians(-0.2), radians(0.2)};
  const DirectionCells cells(pointsAt({{last, 9}}));
  const int row = placeOf(last).row;
  EXPECT_EQ(placeOf(last).column, DirectionCells::kColumns - 1);
  EXPECT_FALSE(cells.at(-1, row).empty());
  EXPECT_FALSE(cells.at(DirectionCells::kColumns - 1, row).empty());
  EXPECT_FALSE(cells.at(-1 - 2 * DirectionCells::kColumns, row).empty());
  EXPECT_TRUE(cells.at(-1, -1).empty());
  EXPECT_TRUE(cells.at(-1, DirectionCells::kRows).empty());
}

}  // namespace
}  // namespace perception
