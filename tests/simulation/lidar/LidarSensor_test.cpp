#include "libperception/simulation/lidar/LidarSensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/weather/particles/Rain.h"
#include "libperception/simulation/weather/particles/Snow.h"
#include "libperception/simulation/world/World.h"
#include "tests/simulation/SceneText.h"

namespace perception {
namespace {

using test::kRoofLidar, test::kStanding, test::parked, test::scenarioOf;

/// One scan of the roof lidar (1.73 m up, at the origin) of a scene at t = 0.
LidarSensor::Scan scanOf(const std::string& objects, const LidarSensorParams& params = {},
                         std::uint64_t seed = 1) {
  const World world(scenarioOf(kStanding + kRoofLidar + objects));
  LidarCaster caster(world);
  const LidarSensor lidar(params, 10);
  return lidar.scan(caster, 0, [](double) { return makePose(0, 0, 1.73, 0); }, {seed, 0, 0, 1});
}

/// Indices of the returns above the road, sensor frame.
std::vector<std::size_t> raised(const LidarCloud& c) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (c.z[i] > -1.73f + 0.15f) result.push_back(i);
  }
  return result;
}

TEST(LidarSensor, HasThePatternOfTheHdl64) {
  const std::vector<double> up = LidarSensorParams().elevations();
  ASSERT_EQ(up.size(), 64u);
  EXPECT_NEAR(degrees(up.front()), -24.33, 0.01);
  EXPECT_NEAR(degrees(up.back()), 2, 1e-9);
  EXPECT_TRUE(std::is_sorted(up.begin(), up.end()));
  EXPECT_EQ(LidarSensor({}, 10).beams(), 64u * 2000u);
  EXPECT_EQ(LidarSensor(LidarSensorParams::fourLayer(), 12.5).beams(), 4u * 441u);
}

TEST(LidarSensor, ReturnsOfABoxLieOnItsFaces) {
  // Faces x = 9 and y = -1, y = 1; noise floor 1 cm, SNR term below 1 cm at 9 m: 6 sigma is 8 cm.
  const auto scan = scanOf(parked("box", "box", 10, 0, "length = 2\nwidth = 2\nheight = 1.2"));
  int count = 0;
  for (const std::size_t i : raised(scan.cloud)) {
    const double x = scan.cloud.x[i], y = scan.cloud.y[i], z = scan.cloud.z[i] + 1.73;
    const double front = std::abs(x - 9), top = std::abs(z - 1.2);
    EXPECT_LT(std::min(front, top), 0.08) << x << ' ' << y << ' ' << z;
    EXPECT_LT(std::abs(y), 1.02);
    ++count;
  }
  // 1.2 m by 2 m at 9 m: 12.7 deg wide, rings from -3.4 to -10.7 deg (a third to half a degree).
  EXPECT_GT(count, 1000);
  EXPECT_GE(scan.points_on.front(), count);
}

TEST(LidarSensor, RangeNoiseHasItsSpread) {
  LidarSensorParams params;
  params.range_noise = 0.05;
  const auto scan =
      scanOf(parked("wall", "box", 15.5, 0, "length = 1\nwidth = 6\nheight = 4"), params);
  double sum = 0, squares = 0;
  int n = 0;
  for (const std::size_t i : raised(scan.cloud)) {
    const Vector3 p(scan.cloud.x[i], scan.cloud.y[i], scan.cloud.z[i]);
    const double error = p.norm() * (1 - 15 / p.x());  // along the beam
    sum += error, squares += error * error, ++n;
  }
  ASSERT_GT(n, 1000);
  // method.md (57) adds .09 m / sqrt(2 SNR) with SNR = .4/.9 (200/15)^2 = 79: sigma = hypot(.05,
  // .0072).
  const double sigma = std::hypot(0.05, 0.0072);
  EXPECT_NEAR(sum / n, 0, 4 * sigma / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), sigma, 4 * sigma / std::sqrt(2.0 * n));
}

TEST(LidarSensor, NothingIsReportedBeyondTheLargestRangeWhateverTheNoise) {
  LidarSensorParams params;
  params.range_noise = 1, params.range_max = 20;
  const auto scan =
      scanOf(parked("wall", "box", 20, 0, "length = 1\nwidth = 6\nheight = 4"), params);
  int at_the_end = 0;
  for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
    const double range = Vector3(scan.cloud.x[i], scan.cloud.y[i], scan.cloud.z[i]).norm();
    EXPECT_LE(range, 20);
    at_the_end += range > 19.99;
  }
  EXPECT_GT(at_the_end, 10) << "returns that the noise would have put beyond";
}

TEST(LidarSensor, PedestrianAtTwentyMetersGetsPlausibleReturns) {
  // The box .5 m by 1.7 m spans 8 columns of .18 deg and 14.6 rings of 1/3 deg: 117 beams; a body
  // fills about half of it.
  const auto scan = scanOf(parked("man", "pedestrian", 20, 0));
  EXPECT_GT(scan.points_on.front(), 30);
  EXPECT_LT(scan.points_on.front(), 117);
}

TEST(LidarSensor, FarRoadAndDarkThingsAreNotSeen) {
  const auto scan = scanOf("");
  double farthest = 0;
  for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
    farthest = std::max(farthest, std::hypot<double>(scan.cloud.x[i], scan.cloud.y[i]));
  }
  EXPECT_GT(farthest, 35);  // as in KITTI's scans
  EXPECT_LT(farthest, 65);
  const std::string wall = "length = 1\nwidth = 6\nheight = 4\n";
  EXPECT_GT(scanOf(parked("wall", "box", 80, 0, wall)).points_on.front(), 100);
  EXPECT_EQ(scanOf(parked("wall", "box", 80, 0, wall + "reflectivity = 0.02")).points_on.front(),
            0);
}

TEST(LidarSensor, GlassLosesMostPulses) {
  // The cabin starts at .6 of 1.5 m; the body below it is paint.
  const auto scan = scanOf(parked("car", "car", 12, 0));
  const std::vector<double> up = LidarSensorParams().elevations();
  int body = 0, glass = 0;
  for (const std::size_t i : raised(scan.cloud)) {
    const double z = scan.cloud.z[i] + 1.73;
    if (z > 0.3 && z < 0.8) ++body;
    if (z > 1.0 && z < 1.4) ++glass;
  }
  EXPECT_GT(body, 100);
  EXPECT_LT(glass, body / 2);
}

TEST(LidarSensor, SameKeySameScanOtherKeyOtherNoise) {
  const std::string scene = parked("car", "car", 12, 0);
  const LidarCloud a = scanOf(scene).cloud, b = scanOf(scene).cloud, c = scanOf(scene, {}, 2).cloud;
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.intensity, b.intensity);
  EXPECT_NE(a.x, c.x);
}

TEST(LidarSensor, FourLayersLabelObjectsAndRoad) {
  const World world(scenarioOf(kStanding + kRoofLidar + parked("car", "car", 12, 0)));
  LidarCaster caster(world);
  const LidarSensor lidar(LidarSensorParams::fourLayer(), 12.5);
  const auto scan =
      lidar.scan(caster, 0, [](double) { return makePose(0, 0, 0.6, 0); }, {1, 0, 0, 1});
  ASSERT_EQ(scan.cloud.label.size(), scan.cloud.size());
  int objects = 0, wrong = 0;
  for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
    const bool is_object = scan.cloud.z[i] > -0.45f;
    const bool says_object = scan.cloud.label[i] == static_cast<std::uint8_t>(PointLabel::kObject);
    objects += is_object;
    wrong += is_object != says_object;
  }
  EXPECT_GT(objects, 50);
  EXPECT_LT(wrong, 0.06 * static_cast<double>(scan.cloud.size()));  // label_error is 1 %
}

/// Shares of the returns of rain or snow that four layers before a street label as rain.
struct Removed {
  double share = 0, echoes = 0;
};
Removed removed(SimulatedWeather& weather, Phantom phantom) {
  const World world(scenarioOf(
      kStanding + kRoofLidar + parked("car", "car", 12, 0) + parked("van", "van", 25, -4) +
      parked("wall", "box", 30, 12, "length = 40\nwidth = 1\nheight = 4")));
  LidarCaster caster(world);
  const LidarSensor lidar(LidarSensorParams::fourLayer(), 12.5);
  SensorParams sensor;
  sensor.lidar = LidarSensorParams::fourLayer();
  double all = 0, rain = 0, second = 0;
  for (std::uint64_t i = 0; i < 60; ++i) {
    weather.advance(world, sensor, .08 * static_cast<double>(i));
    const auto scan = lidar.scan(
        caster, 0, [](double) { return makePose(0, 0, 0.6, 0); }, {1, i, 0, 1},
        [&](LidarPulse& pulse, Rng& rng) { weather.alter(sensor, pulse, rng); });
    const LidarCloud& c = scan.cloud;
    EXPECT_EQ(c.echo.size(), c.size());
    EXPECT_EQ(c.pulse_width.size(), c.size());
    EXPECT_EQ(scan.phantoms.size(), c.size());
    for (std::size_t k = 0; k < c.size(); ++k) {
      second += c.echo[k] == 1;
      if (scan.phantoms[k] != phantom) continue;
      ++all;
      rain += c.label[k] == static_cast<std::uint8_t>(PointLabel::kRain);
      EXPECT_NE(c.label[k], static_cast<std::uint8_t>(PointLabel::kGround));
    }
  }
  EXPECT_GT(all, 300);
  return {rain / all, second / all};
}

// [radecki2016] saw a small portion of the drops go and little effect on flakes; the simulated rule
// takes .48 and .18 in this street, more than that, as its surfaces stand close behind.
TEST(LidarSensor, TheRainRuleTakesMoreDropsThanFlakesAndNoneWithoutASecondEcho) {
  Rain rain(50);
  Snow snow(2.5, 1);
  const Removed drops = removed(rain, Phantom::kRain), flakes = removed(snow, Phantom::kSnow);
  EXPECT_GT(drops.share, 0.1);
  EXPECT_LT(drops.share, drops.echoes);
  EXPECT_LT(flakes.share, 0.5 * flakes.echoes);
  EXPECT_LT(flakes.share, 0.5 * drops.share);
}

TEST(LidarSensor, ADirtyWindowOfFourLayersIsLabelledSo) {
  const World world(scenarioOf(kStanding + kRoofLidar + parked("car", "car", 12, 0)));
  LidarCaster caster(world);
  const LidarSensor lidar(LidarSensorParams::fourLayer(), 12.5);
  const auto scan = lidar.scan(
      caster, 0, [](double) { return makePose(0, 0, 0.6, 0); }, {1, 0, 0, 1},
      [](LidarPulse& pulse, Rng& rng) { pulse.blocked = rng.uniform() < 0.1; });
  const auto& labels = scan.cloud.label;
  const auto dirty =
      std::count(labels.begin(), labels.end(), static_cast<std::uint8_t>(PointLabel::kDirt));
  EXPECT_NEAR(static_cast<double>(dirty) / (4 * 441), 0.1, 0.03);
}

TEST(LidarSensor, SweepSeesThingsAtTheBeamsTime) {
  // A wall that runs away at 20 m/s: straight ahead is half a turn (.05 s) after the start.
  const World world(scenarioOf(kStanding + kRoofLidar +
                               "[object.wall]\nkind = box\nlength = 1\nwidth = 2\nheight = 4\n"
                               "t = 0, 1\nx = 20, 40\ny = 0, 0\n"));
  LidarCaster caster(world);
  LidarSensorParams params;
  params.sweep = true;
  const auto scan =
      LidarSensor(params, 10)
          .scan(caster, 0, [](double) { return makePose(0, 0, 1.73, 0); }, {1, 0, 0, 1});
  ASSERT_EQ(scan.cloud.time_offset.size(), scan.cloud.size());
  int count = 0;
  for (const std::size_t i : raised(scan.cloud)) {
    EXPECT_NEAR(scan.cloud.x[i], 19.5 + 20 * scan.cloud.time_offset[i], 0.1);
    EXPECT_NEAR(scan.cloud.time_offset[i], 0.05, 0.0015 + 0.05 * 3.2 / 180);
    ++count;
  }
  EXPECT_GT(count, 100);
}

}  // namespace
}  // namespace perception
