#include "libperception/simulation/recorded/RecordedScan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/weather/particles/Fog.h"
#include "libperception/simulation/weather/particles/Snow.h"
#include "libperception/simulation/world/World.h"
#include "tests/simulation/SceneText.h"
#include "tests/simulation/recorded/RecordedClouds.h"

namespace perception {
namespace {

using test::kRoofLidar, test::kStanding, test::leftHalf, test::wallCloud;

struct Played {
  WeatheredScan scan;
  std::size_t before;
  std::size_t phantoms() const {
    return static_cast<std::size_t>(std::count_if(scan.phantoms.begin(), scan.phantoms.end(),
                                                  [](Phantom p) { return p != Phantom::kNone; }));
  }
};

Played play(SimulatedWeather& weather, const LidarCloud& cloud,
            const std::vector<BeamPattern::Beam>& missing = {}, int threads = 1) {
  const World world(test::scenarioOf(kStanding + kRoofLidar));
  LidarCaster caster(world, threads);
  caster.setTime(0);
  const SensorParams& sensor = world.scenario().sensors.front();
  weather.advance(world, sensor, 0);
  return {
      throughWeather(cloud, missing, weather, sensor, makePose(0, 0, 1.9, 0), caster, {7, 0, 0, 1}),
      cloud.size()};
}

TEST(RecordedScan, ClearAirLeavesEveryBitAsItIs) {
  SimulatedWeather clear;
  for (const float intensity : {0.0f, 0.3f}) {  // also what was just above the threshold
    const LidarCloud cloud = wallCloud(60, intensity);
    const Played p = play(clear, cloud);
    EXPECT_EQ(p.scan.lost, 0u);
    EXPECT_EQ(p.scan.cloud.x, cloud.x);
    EXPECT_EQ(p.scan.cloud.y, cloud.y);
    EXPECT_EQ(p.scan.cloud.z, cloud.z);
    EXPECT_EQ(p.scan.cloud.intensity, cloud.intensity);
    EXPECT_EQ(p.scan.cloud.ring, cloud.ring);
    EXPECT_EQ(p.phantoms(), 0u);
  }
}

TEST(RecordedScan, FogTakesIntensityAndReturnsItself) {
  Fog fog(50);
  const Played near = play(fog, wallCloud(6, 0.5f)), far = play(fog, wallCloud(80, 0.05f));
  EXPECT_EQ(near.phantoms(), 0u);
  EXPECT_EQ(near.scan.cloud.size(), near.before);
  EXPECT_LT(near.scan.cloud.intensity[45], 0.5f * std::exp(-2 * 6 * 0.059f));
  EXPECT_GT(near.scan.cloud.intensity[45], 0);
  EXPECT_EQ(far.phantoms() + far.scan.lost, far.before);  // nothing of the wall is left
}

TEST(RecordedScan, FlakesAreOnTheBeamsThatReturnedAndOnThoseThatDidNot) {
  Snow snow(20, 1);
  const LidarCloud cloud = wallCloud(30), half = leftHalf(cloud);
  BeamPattern pattern;
  pattern.missing(cloud);
  const Played p = play(snow, half, pattern.missing(half));
  int left = 0, right = 0;
  for (std::size_t i = 0; i < p.scan.cloud.size(); ++i) {
    if (p.scan.phantoms[i] != Phantom::kSnow) {
      EXPECT_EQ(p.scan.cloud.x[i], 30);
      continue;
    }
    EXPECT_LT(p.scan.cloud.x[i], 30);
    ++(p.scan.cloud.y[i] < 0 ? right : left);
  }
  EXPECT_GT(left, 20);
  EXPECT_GT(right, 20);
}

TEST(RecordedScan, FlakesHaveIntensitiesInTheStepsOfTheRecording) {
  for (const float step : {0.004f, 0.01f}) {
    Snow snow(20, 1);
    LidarCloud cloud = wallCloud(30, 0.5f);
    cloud.intensity[0] = step;
    const Played p = play(snow, cloud);
    int flakes = 0, bright = 0;
    for (std::size_t i = 0; i < p.scan.cloud.size(); ++i) {
      if (p.scan.phantoms[i] != Phantom::kSnow) continue;
      const float steps = p.scan.cloud.intensity[i] / step;
      EXPECT_NEAR(steps, std::round(steps), 1e-3) << p.scan.cloud.intensity[i];
      ++flakes, bright += p.scan.cloud.intensity[i] > 0;
    }
    EXPECT_GT(flakes, 20);
    EXPECT_GT(bright, 0);
  }
}

TEST(RecordedScan, ThreadsDoNotMatter) {
  Snow one(5, 1), four(5, 1);
  const Played a = play(one, wallCloud(30), {}, 1), b = play(four, wallCloud(30), {}, 4);
  EXPECT_EQ(a.scan.cloud.x, b.scan.cloud.x);
  EXPECT_EQ(a.scan.cloud.intensity, b.scan.cloud.intensity);
}

/// Makes every return of the road a phantom of noise, so that it is seen which are.
class OnRoad final : public SimulatedWeather {
 public:
  using SimulatedWeather::alter;
  void alter(const SensorParams&, LidarPulse& pulse, Rng&) const override {
    if (pulse.hit.object == BeamHit::kRoad) pulse.blocked = true;
  }
};

TEST(RecordedScan, TheRoadIsWhatLiesLowest) {
  LidarCloud cloud;
  const auto add = [&](double x, double y, double up) {  // height above the road, sensor at 1.9 m
    cloud.x.push_back(static_cast<float>(x)), cloud.y.push_back(static_cast<float>(y));
    cloud.z.push_back(static_cast<float>(up - 1.9));
  };
  for (int i = 0; i < 20; ++i) add(8 + 0.1 * i, 0.5, 0.05 * (i % 2));  // road, rough
  for (int i = 0; i < 20; ++i) add(9, 0.3, 0.3 + 0.05 * i);            // a post on it
  OnRoad road;
  const Played p = play(road, cloud);
  EXPECT_EQ(p.scan.lost, 20u);
  EXPECT_EQ(p.scan.cloud.size(), 20u);
}

}  // namespace
}  // namespace perception
