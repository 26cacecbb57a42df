#include "libperception/simulation/weather/Beam.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/simulation/weather/WeatherBeams.h"

namespace perception {
namespace {

TEST(Beam, AirAttenuatesUpToTheSurface) {
  LidarPulse wall = test::wallPulse(20), sky = test::skyPulse(0, 0.1);
  attenuate(wall, 0.01), attenuate(wall, 0.02), attenuate(sky, 0.01);
  EXPECT_NEAR(wall.optical_depth, 0.6, 1e-9);
  EXPECT_EQ(sky.optical_depth, 0);
  EXPECT_EQ(openRange(wall), 20);
  EXPECT_GT(openRange(sky), 1e9);
}

TEST(Beam, CellsOfDirectionsCloseRoundTheTurn) {
  AimGrid grid(radians(10));
  grid.shift(0.3, 0.6);
  std::set<std::size_t> cells;
  for (int azimuth = -180; azimuth < 180; ++azimuth) {
    const AimGrid::Place place = grid.at(radians(azimuth + .5), 0.01);
    cells.insert(place.cell);
    EXPECT_LT(place.cell, grid.cells());
    EXPECT_GE(place.across, 0);
    EXPECT_LT(place.across, 1);
  }
  EXPECT_EQ(cells.size(), 36u);
  EXPECT_EQ(grid.at(kPi, 0).cell, grid.at(-kPi, 0).cell);
  EXPECT_LT(grid.at(kPi, kPi / 2).cell, grid.cells());
}

TEST(Beam, SensorsHaveTheirOwnRandomNumbers) {
  EXPECT_NE(streamOf("IBEO_LEFT", 1), streamOf("IBEO_RIGHT", 1));
  EXPECT_NE(streamOf("IBEO_LEFT", 1), streamOf("IBEO_LEFT", 2));
}

}  // namespace
}  // namespace perception
