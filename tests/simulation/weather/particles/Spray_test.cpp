#include "libperception/simulation/weather/particles/Spray.h"

#include <gtest/gtest.h>

#include "tests/simulation/weather/WeatherBeams.h"

namespace perception {
namespace {

using test::kRoofLidar, test::kStanding, test::scenarioOf;

/// A car that drives away at a speed [m/s] along x; it is at x = 10 m at t = 5 s.
World street(double speed) {
  const double first = 10 - 5 * speed, last = 10 + 5 * speed;
  return World(scenarioOf(kStanding + kRoofLidar + "[object.car]\nkind = car\nt = 0, 10\nx = " +
                          std::to_string(first) + ", " + std::to_string(last) + "\ny = 0, 0\n"));
}

/// Clusters that are born in `cycles` cycles.
double bornIn(Spray& spray, const World& world, int cycles) {
  const SensorParams& sensor = world.scenario().sensors.front();
  double count = 0;
  for (int k = 0; k < cycles; ++k) {
    spray.advance(world, sensor, 2 + k * Spray::kCycle);
    for (const auto& c : spray.clusters()) count += c.age == 0;
  }
  return count;
}

TEST(Spray, ClustersAreAsManyAsTheLawSays) {
  const World world = street(25);  // 90 km/h
  Spray spray(1, 0, Vector2::Zero(), 7);
  EXPECT_NEAR(spray.born(25), (0.2 * 1 + 0.1) * 40, 1e-9);
  EXPECT_NEAR(bornIn(spray, world, 40) / 40, 12, 0.3);
}

TEST(Spray, SlowVehiclesOnlyRaiseSnow) {
  const World world = street(10);  // 36 km/h
  Spray water(1, 0, Vector2::Zero(), 7), snow(0, 1, Vector2::Zero(), 7);
  EXPECT_EQ(bornIn(water, world, 20), 0);
  EXPECT_NEAR(bornIn(snow, world, 20) / 20, 0.3 * 21, 0.5);
}

TEST(Spray, IsBornBehindTheVehicleAndSlowsDown) {
  const World world = street(25);
  Spray spray(1, 0, Vector2::Zero(), 7);
  spray.advance(world, world.scenario().sensors.front(), 5.0);
  ASSERT_GT(spray.clusters().size(), 100u);
  for (const auto& c : spray.clusters()) {
    EXPECT_LT(c.position.x(), 10 - 2.2);
    EXPECT_LE(c.radius, 1);
    EXPECT_LE(c.age, 4 * c.life + 1e-9);
    const bool slowed = c.age <= 1 || c.drag > -0.05 || c.velocity.head<2>().norm() < 15;
    EXPECT_TRUE(slowed) << c.velocity.transpose();
  }
}

TEST(Spray, BeamsThroughItReturnDimlyAndBeforeTheSurface) {
  const World world = street(25);
  const SensorParams& sensor = world.scenario().sensors.front();
  Spray spray(1, 0, Vector2::Zero(), 7);
  spray.advance(world, sensor, 5.0);
  int through = 0, returns = 0, aside = 0;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    Rng rng({1, 0, i, 0});
    LidarPulse pulse = test::wallPulse(8);
    const double azimuth = radians(-180 + 0.09 * i);
    pulse.origin = {0, 0, 1};
    pulse.direction = {std::cos(azimuth), std::sin(azimuth), 0};
    spray.alter(sensor, pulse, rng);
    through += pulse.optical_depth > 0;
    for (const auto& s : pulse.scatterers) {
      ++returns, aside += std::abs(s.range * std::sin(azimuth)) > 3;
      EXPECT_LT(s.range, 8);
      EXPECT_LT(s.intensity, 1.0 / 255);
      EXPECT_EQ(s.phantom, Phantom::kSpray);
    }
  }
  EXPECT_GT(through, 200);
  EXPECT_GT(returns, 20);
  EXPECT_EQ(aside, 0);
}

TEST(Spray, LowersTheContrastBehindIt) {
  const World world(scenarioOf(kStanding + test::kCamera +
                               "[object.car]\nkind = car\nt = 0, 10\nx = -115, 135\ny = 0, 0\n"));
  const SensorParams& camera = world.scenario().sensors.front();
  Spray spray(1, 0, Vector2::Zero(), 7);
  spray.advance(world, camera, 5.0);
  Rng rng({1, 0, 0, 0});
  CameraLook car, aside;
  car.range = 9, aside.range = 9, aside.azimuth = radians(90);
  spray.alter(camera, car, rng);
  spray.alter(camera, aside, rng);
  EXPECT_GT(car.optical_depth, 0.01);
  EXPECT_EQ(aside.optical_depth, 0);
}

}  // namespace
}  // namespace perception
