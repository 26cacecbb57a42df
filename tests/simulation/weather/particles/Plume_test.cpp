#include "libperception/simulation/weather/particles/Plume.h"

#include <gtest/gtest.h>

#include "tests/simulation/weather/WeatherBeams.h"

namespace perception {
namespace {

using test::kRoofLidar, test::kStanding, test::parked, test::scenarioOf;

// A car that waits at x = 12 m until t = 20 s and then drives on, another one that is parked.
const World& plumeStreet() {
  static const World world(
      scenarioOf(kStanding + kRoofLidar +
                 "[object.waiting]\nkind = car\nt = 0, 20, 30\nx = 12, 12, 112\ny = 0, 0, 0\n" +
                 parked("parked", "car", 12, 5)));
  return world;
}

const SensorParams& lidar() { return plumeStreet().scenario().sensors.front(); }

TEST(Plume, RisesFromThePipeOfWaitingVehiclesAndDriftsWithTheWind) {
  Plume still(Vector2::Zero(), 7), wind({0, 2}, 7);
  still.advance(plumeStreet(), lidar(), 10);
  wind.advance(plumeStreet(), lidar(), 10);
  ASSERT_NEAR(static_cast<double>(still.puffs().size()), 16 + 16, 2);  // 20 and 5 a second
  for (std::size_t i = 0; i < still.puffs().size(); ++i) {
    const double age = (still.puffs()[i].place.z() - 0.3) / 0.3;
    const auto &a = still.puffs()[i], &b = wind.puffs()[i];
    EXPECT_NEAR(a.place.x(), 12 - 2.25, 0.02);
    EXPECT_GE(age, -1e-6);
    EXPECT_LT(age, 4);
    EXPECT_NEAR(b.place.y() - a.place.y(), 2 * age, 0.05);
    EXPECT_NEAR(a.sigma, 0.12 + 0.25 * std::pow(age, 0.75), 0.01);
    EXPECT_LE(a.extinction, 0.5);
  }
}

TEST(Plume, WakeDragsItBehindMovingVehicles) {
  Plume plume(Vector2::Zero(), 7);
  plume.advance(plumeStreet(), lidar(), 26);
  const double speed = plumeStreet().object(0, 25).velocity.norm();
  ASSERT_GT(speed, 5);
  const double left = plumeStreet().object(0, 24).T_world_object.translation().x() - 2.25;
  double x = 0;  // of the puff that is 2 s old
  for (const auto& puff : plume.puffs())
    if (std::abs((puff.place.z() - 0.3) / 0.3 - 2) < 0.01) x = puff.place.x();
  EXPECT_GT(x, left + 0.2 * 0.8 * speed);
  EXPECT_LT(x, left + 0.3 * 0.8 * speed * 1.3);
}

/// Share of level beams at a height [m] into the plume that return from it; with their depth.
struct Answer {
  double returns = 0, depth = 0;
};
Answer answerAt(double height, double y = -0.54) {
  Plume plume(Vector2::Zero(), 7);
  plume.advance(plumeStreet(), lidar(), 10);
  Answer answer;
  const int beams = 4000;
  for (int i = 0; i < beams; ++i) {
    Rng rng({1, 0, static_cast<std::uint32_t>(i), 0});
    LidarPulse pulse;
    pulse.origin = {0, y, height}, pulse.direction = Vector3::UnitX();
    plume.alter(lidar(), pulse, rng);
    answer.depth = pulse.optical_depth;
    for (const auto& s : pulse.scatterers) {
      answer.returns += 1.0 / beams;
      EXPECT_NEAR(s.range, 12 - 2.25, 1.5);
      EXPECT_GE(s.intensity, 5.0 / 255);
      EXPECT_LE(s.intensity, 15.0 / 255);
    }
  }
  return answer;
}

TEST(Plume, ReturnsAsOftenAsItsDepthSays) {
  const Answer low = answerAt(0.5);
  EXPECT_GT(low.depth, 0.5);
  EXPECT_NEAR(low.returns, 0.6 * (1 - std::exp(-low.depth)), 0.05);
  const Answer high = answerAt(1.5);
  EXPECT_LT(high.depth, low.depth);
  EXPECT_LT(high.returns, low.returns);
  EXPECT_EQ(answerAt(0.5, 5).depth, 0) << "parked vehicles are off";
}

}  // namespace
}  // namespace perception
