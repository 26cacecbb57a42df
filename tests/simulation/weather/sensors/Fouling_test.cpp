#include "libperception/simulation/weather/sensors/Fouling.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/simulation/weather/WeatherBeams.h"

namespace perception {
namespace {

TEST(Fouling, BlocksItsShareOfTheLidarsDirectionsForGood) {
  Fouling dirt(0.2, 0, 7);
  std::vector<std::set<int>> blocked(2);
  int scan = -1;
  test::scanSky(dirt, 2, [&](int ring, int column, const LidarPulse& pulse) {
    if (ring == 0 && column == 0) ++scan;
    if (pulse.blocked) blocked[static_cast<std::size_t>(scan)].insert(720 * ring + column);
  });
  EXPECT_EQ(blocked[0], blocked[1]);
  EXPECT_NEAR(static_cast<double>(blocked[0].size()) / (16 * 720), 0.2, 0.04);
}

TEST(Fouling, WetRadomeTakesPowerBothWays) {
  Rng rng({1, 0, 0, 0});
  RadarReflection reflection;
  reflection.snr = 100;
  Fouling(0, 3, 1).alter(SensorParams(), reflection, rng);
  EXPECT_NEAR(reflection.snr, 25.1, 0.1);
  RadarAir air;
  Fouling(0, 3, 1).alter(SensorParams(), air, rng);
  EXPECT_NEAR(air.passing, 0.251, 0.001);
}

TEST(Fouling, BlursACamerasImageInPatches) {
  const World world(test::scenarioOf(test::kStanding + test::kCamera));
  const SensorParams& camera = world.scenario().sensors.front();
  Fouling dirt(0.3, 0, 7);
  dirt.advance(world, camera, 0);
  Rng rng({1, 0, 0, 0});
  int blurred = 0;
  for (int i = 0; i < 36; ++i) {
    CameraLook look;
    look.chance = 1, look.azimuth = radians(10 * i + 5);
    dirt.alter(camera, look, rng);
    blurred += look.chance < 1;
  }
  EXPECT_GE(blurred, 4);
  EXPECT_LE(blurred, 18);
}

}  // namespace
}  // namespace perception
