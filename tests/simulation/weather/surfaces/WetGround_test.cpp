#include "libperception/simulation/weather/surfaces/WetGround.h"

#include <gtest/gtest.h>

#include "libperception/simulation/lidar/LidarSensor.h"
#include "libperception/simulation/world/World.h"
#include "tests/simulation/SceneText.h"

namespace perception {
namespace {

using test::kRoofLidar, test::kStanding, test::parked, test::scenarioOf;

constexpr double kLidarHeight = 1.73;  // [m] of the lidar

/// Scan of a street with a wall whose face is at x = 24.5 m.
LidarSensor::Scan wetScan(double film_mm, const std::string& objects) {
  const World world(scenarioOf(kStanding + kRoofLidar + objects));
  LidarCaster caster(world);
  LidarSensorParams p;
  p.azimuth_from = radians(-10), p.azimuth_to = radians(10);
  p.range_noise = 0, p.loss = 0;
  WetGround wet(film_mm);
  const SensorParams& sensor = world.scenario().sensors.front();
  wet.advance(world, sensor, 0);
  const PulseHook hook = [&](LidarPulse& pulse, Rng& rng) { wet.alter(sensor, pulse, rng); };
  const auto at = [](double) { return makePose(0, 0, kLidarHeight, 0); };
  return LidarSensor(p, 10).scan(caster, 0, at, {1, 0, 0, 1}, hook);
}

const std::string kWall = parked("wall", "box", 25, 0, "length = 1\nwidth = 20\nheight = 4");

double farthestGround(const LidarSensor::Scan& scan) {
  double most = 0;
  for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
    const bool ground = std::abs(scan.cloud.z[i] + kLidarHeight) < 0.1;
    if (ground) most = std::max<double>(most, scan.cloud.x[i]);
  }
  return most;
}

TEST(WetGround, IsLostFarAway) {
  EXPECT_GT(farthestGround(wetScan(0, "")), 40);
  EXPECT_LT(farthestGround(wetScan(1.2, "")), 30);
  EXPECT_GT(farthestGround(wetScan(1.2, "")), 12);
}

TEST(WetGround, GhostsAreMirrorImagesBelowTheRoad) {
  const auto scan = wetScan(1.2, kWall);
  int ghosts = 0, under_the_wall = 0;
  for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
    if (scan.phantoms[i] != Phantom::kMirror) continue;
    ++ghosts;
    EXPECT_LT(scan.cloud.z[i], -kLidarHeight + 0.02);
    EXPECT_GT(scan.cloud.z[i], -kLidarHeight - 4) << "the wall is 4 m high";
    under_the_wall += std::abs(scan.cloud.x[i] - 24.5) < 0.4;
  }
  EXPECT_GT(ghosts, 20);
  EXPECT_EQ(under_the_wall, ghosts);
}

TEST(WetGround, DryRoadMirrorsNothing) {
  const auto scan = wetScan(0, kWall);
  EXPECT_EQ(std::count(scan.phantoms.begin(), scan.phantoms.end(), Phantom::kMirror), 0);
  const auto empty = wetScan(1.2, "");
  EXPECT_EQ(std::count(empty.phantoms.begin(), empty.phantoms.end(), Phantom::kMirror), 0);
}

TEST(WetGround, DetourOverTheRoadMovesObjectsByMillimeters) {
  const auto moved = [](double film_mm) {
    LidarPulse pulse;
    pulse.origin = {0, 0, 1.9}, pulse.direction = Vector3(20, 0, -0.9).normalized();
    pulse.hit.object = 0, pulse.hit.range = 20;
    Rng rng({1, 0, 0, 0});
    WetGround(film_mm).alter(SensorParams(), pulse, rng);
    return pulse.hit.range - 20.0;
  };
  EXPECT_EQ(moved(0), 0);
  EXPECT_GT(moved(1.2), 1e-4);
  EXPECT_LT(moved(1.2), 0.02);
}

}  // namespace
}  // namespace perception
