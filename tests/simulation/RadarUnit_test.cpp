#include "libperception/simulation/RadarUnit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/world/World.h"
#include "tests/simulation/SceneText.h"

namespace perception {
namespace {

using test::kCamera, test::kStanding, test::parked, test::scenarioOf;

/// A unit without faults of its own.
RadarUnitParams perfectRadar() {
  RadarUnitParams p;
  p.fov = radians(90);
  p.range_noise = p.bearing_noise = p.rate_noise = 0;
  p.person = p.cyclist = p.vehicle = p.surroundings = 1;
  p.ground_per_scan = p.false_per_scan = p.double_bounce = 0;
  return p;
}

RadarMount mountAt(double x, double y, double yaw) {
  RadarMount mount;
  mount.T_world_sensor = makePose(x, y, 0.5, yaw);
  return mount;
}

std::string driving(const std::string& kind, double x0, double x1, double y) {
  return "[object.mover]\nkind = " + kind + "\nt = 0, 1\nx = " + std::to_string(x0) + ", " +
         std::to_string(x1) + "\ny = " + std::to_string(y) + ", " + std::to_string(y) + "\n";
}

TEST(RadarUnit, CarAnswersFromTheSideThatFacesTheUnit) {
  const World world(scenarioOf(kStanding + kCamera + parked("car", "car", 30, 0)));
  const LidarCaster caster(world);
  const auto reflections = radarReflections(caster, 0, perfectRadar(), mountAt(0, 0, 0));
  ASSERT_FALSE(reflections.empty());
  const auto strongest =
      std::max_element(reflections.begin(), reflections.end(),
                       [](const auto& a, const auto& b) { return a.snr < b.snr; });
  EXPECT_NEAR(strongest->range, 30 - 2.25, 0.05);  // its rear, 4.5 m long
  for (const auto& r : reflections) EXPECT_LT(r.range, 30) << "a side that faces away answers";
}

TEST(RadarUnit, RangeRateIsRelativeToTheMovingUnit) {
  const World world(scenarioOf(kStanding + kCamera + driving("pedestrian", 20, 23, 0)));
  const LidarCaster caster(world);
  RadarMount mount = mountAt(0, 0, 0);
  mount.velocity = {5, 0};
  const auto returns = radarReturns(caster, 0, perfectRadar(), mount, {1, 0, 0, 1});
  ASSERT_EQ(returns.returns.size(), 1u);
  EXPECT_NEAR(returns.returns[0].range, 20, 1e-6);
  EXPECT_NEAR(returns.returns[0].range_rate, 3 - 5, 1e-6);
  EXPECT_NEAR(returns.returns[0].bearing, 0, 1e-9);
}

TEST(RadarUnit, BearingsAreMirroredWhenItHangsOnItsHead) {
  const World world(scenarioOf(kStanding + kCamera + parked("man", "pedestrian", 10, 2)));
  const LidarCaster caster(world);
  RadarUnitParams p = perfectRadar();
  const RadarMount mount = mountAt(0, 0, 0);
  const double upright = radarReturns(caster, 0, p, mount, {1, 0, 0, 1}).returns.at(0).bearing;
  p.upside_down = true;
  EXPECT_NEAR(upright, std::atan2(2, 10), 1e-9);
  EXPECT_NEAR(radarReturns(caster, 0, p, mount, {1, 0, 0, 1}).returns.at(0).bearing, -upright,
              1e-12);
}

TEST(RadarUnit, ReflectionsOfOneCellAreOneTarget) {
  // Two walkers side by side: 0.6 m apart at 20 m is 1.7 deg; the third stands 3 m behind.
  const World world(scenarioOf(kStanding + kCamera + parked("a", "pedestrian", 20, 0.3) +
                               parked("b", "pedestrian", 20, -0.3) +
                               parked("c", "pedestrian", 23, 1.8)));
  const LidarCaster caster(world);
  const auto list = radarReturns(caster, 0, perfectRadar(), mountAt(0, 0, 0), {1, 0, 0, 1}).returns;
  ASSERT_EQ(list.size(), 2u);
  EXPECT_NEAR(list[0].range, 20, 0.05);
  EXPECT_NEAR(list[0].bearing, 0, radians(0.5));
  EXPECT_NEAR(list[1].range, std::hypot(23, 1.8), 1e-6);
}

TEST(RadarUnit, WallsHideAndCarsLetALittleThrough) {
  const std::string far_car = parked("far", "car", 30, 0);
  const auto strongest = [](const std::string& scene) {
    const World world(scenarioOf(kStanding + kCamera + scene));
    const LidarCaster caster(world);
    double power = 0;
    for (const auto& r : radarReflections(caster, 0, perfectRadar(), mountAt(0, 0, 0))) {
      if (r.object == 0) power = std::max(power, r.snr);
    }
    return power;
  };
  const double open = strongest(far_car);
  EXPECT_GT(open, 1000);
  EXPECT_EQ(strongest(far_car + parked("wall", "box", 20, 0, "length = 1\nwidth = 9")), 0);
  const double behind = strongest(far_car + parked("near", "car", 20, 0));
  EXPECT_GT(behind, 0);
  EXPECT_LT(behind, 0.05 * open);
}

TEST(RadarUnit, SharesOfDetectionAreThoseOfTheClasses) {
  const World world(scenarioOf(kStanding + kCamera + parked("man", "pedestrian", 15, 0) +
                               parked("car", "car", 40, 0)));
  const LidarCaster caster(world);
  RadarUnitParams p = perfectRadar();
  p.person = RadarUnitParams().person, p.vehicle = RadarUnitParams().vehicle;
  constexpr int kScans = 2000;
  int men = 0, cars = 0;
  for (std::uint64_t i = 0; i < kScans; ++i) {
    bool man = false, car = false;
    for (const auto& r : radarReturns(caster, 0, p, mountAt(0, 0, 0), {1, i, 0, 1}).returns) {
      (r.range < 20 ? man : car) = true;
    }
    men += man, cars += car;
  }
  const auto sigma = [](double share) { return std::sqrt(share * (1 - share) * kScans); };
  EXPECT_NEAR(men, .05 * kScans, 4 * sigma(.05));
  // The car is a little less often detected than resolved: its echo fluctuates (Swerling 1).
  EXPECT_LT(cars, .90 * kScans + 4 * sigma(.9));
  EXPECT_GT(cars, .88 * kScans - 4 * sigma(.88));
}

TEST(RadarUnit, CarAtTheReferenceRangeIsFoundEverySecondTime) {
  // Only the power counts here: the detection rule on a single reflection of the car's size.
  const World world(scenarioOf(kStanding + kCamera + parked("car", "car", 100, 0)));
  const LidarCaster caster(world);
  RadarUnitParams p = perfectRadar();
  RadarReflection one;
  int calls = 0;
  const RadarHook only_one = [&](RadarReflection& r, Rng&) {
    if (calls++ == 0) {
      r.snr = std::log(p.false_alarm) / std::log(.5) - 1;
    } else {
      r.snr = 0;
    }
  };
  constexpr int kScans = 1000;
  int found = 0;
  for (std::uint64_t i = 0; i < kScans; ++i) {
    calls = 0;
    found += static_cast<int>(
        radarReturns(caster, 0, p, mountAt(0, 0, 0), {1, i, 0, 1}, only_one).returns.size());
  }
  EXPECT_NEAR(found, .5 * kScans, 4 * std::sqrt(.25 * kScans));
}

TEST(RadarUnit, NoiseIsThatOfTheParameters) {
  const World world(scenarioOf(kStanding + kCamera + parked("man", "pedestrian", 20, 0)));
  const LidarCaster caster(world);
  RadarUnitParams p = perfectRadar();
  p.range_noise = .5, p.bearing_noise = radians(2), p.rate_noise = .15;
  constexpr int kScans = 1000;
  int n = 0;
  Vector3 sum = Vector3::Zero();
  for (std::uint64_t i = 0; i < kScans; ++i) {
    for (const auto& r : radarReturns(caster, 0, p, mountAt(0, 0, 0), {1, i, 0, 1}).returns) {
      sum += Vector3((r.range - 20) / .5, r.bearing / radians(2), r.range_rate / .15).cwiseAbs2();
      ++n;
    }
  }
  ASSERT_GT(n, 900);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(sum(k) / n, 1, 4 * std::sqrt(2.0 / n)) << k;
}

TEST(RadarUnit, FalseTargetsAndGroundHaveTheirRates) {
  const World world(scenarioOf(kStanding + kCamera));
  const LidarCaster caster(world);
  RadarUnitParams p = perfectRadar();
  p.ground_per_scan = .4, p.false_per_scan = .2;
  RadarMount mount = mountAt(0, 0, radians(90));
  mount.velocity = {0, 6};  // it drives where it looks
  constexpr int kScans = 1000;
  int still = 0, all = 0;
  for (std::uint64_t i = 0; i < kScans; ++i) {
    for (const auto& r : radarReturns(caster, 0, p, mount, {1, i, 0, 1}).returns) {
      still += std::abs(r.range_rate + 6 * std::cos(r.bearing)) < 1e-9;
      ++all;
    }
  }
  EXPECT_NEAR(still, .4 * kScans, 4 * std::sqrt(.4 * kScans));
  EXPECT_NEAR(all - still, .2 * kScans, 4 * std::sqrt(.2 * kScans));
}

TEST(RadarUnit, ListHoldsNoMoreThanTheUnitTracks) {
  std::string scene = kStanding + kCamera;
  for (int i = 0; i < 12; ++i) {
    scene += parked("p" + std::to_string(i), "pole", 10 + 4 * i, (i % 2 ? 2 : -2));
  }
  const World world(scenarioOf(scene));
  const LidarCaster caster(world);
  RadarUnitParams p = perfectRadar();
  p.max_targets = 5;
  const auto list = radarReturns(caster, 0, p, mountAt(0, 0, 0), {1, 0, 0, 1}).returns;
  EXPECT_EQ(list.size(), 5u);
  EXPECT_TRUE(std::is_sorted(list.begin(), list.end(),
                             [](const auto& a, const auto& b) { return a.range < b.range; }));
}

}  // namespace
}  // namespace perception
