#include "libperception/weather/trust/PointTrust.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "libperception/config/Config.h"
#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"

namespace perception {
namespace {

constexpr double kLidarHeight = 1.8;  // [m] of the lidar

/// A return of the scene below and what it is of.
enum class Source { kGround, kWall, kFlake };

struct Scene {
  SensorFrame frame;
  std::vector<Source> sources;
  LidarCloud& cloud() { return std::get<LidarCloud>(frame.data); }
  void add(const Vector3& p, float intensity, Source source) {
    LidarCloud& c = cloud();
    c.x.push_back(static_cast<float>(p.x())), c.y.push_back(static_cast<float>(p.y()));
    c.z.push_back(static_cast<float>(p.z())), c.intensity.push_back(intensity);
    sources.push_back(source);
  }
};

/// 64 beams over flat ground and a wall all around at 25 m; one beam in `flakes` meets a flake.
Scene sceneOf(double flakes, std::uint64_t seed, float flake_intensity = 0,
              float wall_intensity = 0.3F) {
  Scene scene;
  scene.frame.sensor = "LIDAR";
  scene.frame.T_ego_sensor = makePose(0, 0, kLidarHeight, 0);
  scene.frame.ground.measured = true;
  scene.frame.data = LidarCloud{};
  Rng random({seed, 0, 0, 0});
  for (int step = 0; step < 1800; ++step)
    for (int beam = 0; beam < 64; ++beam) {
      const double a = radians(step * 0.2 - 180 + 0.05), e = radians(-24.3 + 0.42 * beam);
      const Vector3 d(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
      if (random.uniform(0, 1) < flakes) {
        const double r = std::exp(1.87 + 0.3 * random.normal());  // as WADS has them
        if (d.z() * r >
            -kLidarHeight + 1) {  // lower, nothing tells them from what lies on the road
          scene.add(r * d, flake_intensity, Source::kFlake);
          continue;
        }
      }
      const double ground = d.z() < 0 ? -kLidarHeight / d.z() : 1e9;
      const double wall = 25 / std::cos(e);
      const double r = std::min(ground, wall) + 0.01 * random.normal();
      scene.add(r * d, wall_intensity, ground < wall ? Source::kGround : Source::kWall);
    }
  return scene;
}

struct Shares {
  double flakes_found = 0, surfaces_lost = 0;
};
Shares sharesOf(Scene& scene) {
  double flakes = 0, found = 0, surfaces = 0, lost = 0;
  for (std::size_t i = 0; i < scene.sources.size(); ++i) {
    const bool doubted = scene.cloud().trust[i] < 0.5F;
    const bool flake = scene.sources[i] == Source::kFlake;
    flakes += flake, found += flake && doubted;
    surfaces += !flake, lost += !flake && doubted;
  }
  return {flakes > 0 ? found / flakes : 0, lost / surfaces};
}

TEST(PointTrust, FindsFlakesAndKeepsSurfaces) {
  const auto trust = makePointTrust({});
  Scene scene = sceneOf(0.05, 1);
  trust->apply(scene.frame);
  const Shares shares = sharesOf(scene);
  EXPECT_GT(shares.flakes_found, 0.9);
  EXPECT_LT(shares.surfaces_lost, 0.002);
}

TEST(PointTrust, LearnsBrightFlakesFromTheirGeometry) {
  const auto trust = makePointTrust({});
  Scene scene = sceneOf(0.05, 1, 0.8F, 0);
  trust->apply(scene.frame);
  EXPECT_GT(sharesOf(scene).flakes_found, 0.9);
  EXPECT_LT(sharesOf(scene).surfaces_lost, 0.002);
}

TEST(PointTrust, DoubtsNothingInClearAir) {
  const auto trust = makePointTrust({});
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Scene scene = sceneOf(0, seed);
    const TrustStats stats = trust->apply(scene.frame);
    EXPECT_EQ(stats.phantoms, 0U);
    EXPECT_LT(stats.share, 1e-3);
  }
}

TEST(PointTrust, ShareFollowsTheWeather) {
  PointTrust trust({});
  Scene snow = sceneOf(0.08, 1);
  trust.apply(snow.frame);
  const double in_snow = trust.share();
  Scene clear = sceneOf(0, 2);
  for (int scan = 0; scan < 30; ++scan) trust.apply(clear.frame);
  EXPECT_GT(in_snow, 0.03);
  EXPECT_LT(trust.share(), 0.1 * in_snow);
}

TEST(PointTrust, WorksWithoutIntensity) {
  const auto trust = makePointTrust({});
  Scene scene = sceneOf(0.05, 1);
  scene.cloud().intensity.clear();
  trust->apply(scene.frame);
  EXPECT_GT(sharesOf(scene).flakes_found, 0.8);
  EXPECT_LT(sharesOf(scene).surfaces_lost, 0.005);
}

TEST(PointTrust, SparseBeamsTakeCoarserRows) {
  for (const int every : {1, 4}) {
    PointTrust trust({});
    Scene dense = sceneOf(0.03, 1), scene;
    scene.frame = dense.frame;
    scene.frame.data = LidarCloud{};
    for (std::size_t i = 0; i < dense.sources.size(); ++i) {
      const LidarCloud& c = dense.cloud();
      const double e = degrees(std::atan2(c.z[i], std::hypot(c.x[i], c.y[i])));
      if (std::lround((e + 24.3) / 0.42) % every != 0) continue;
      scene.add(Vector3(c.x[i], c.y[i], c.z[i]), c.intensity[i], dense.sources[i]);
    }
    trust.apply(scene.frame);
    EXPECT_GT(trust.rowPitch(), radians(every == 1 ? 0.3 : 1.0));
    EXPECT_LT(trust.rowPitch(), radians(every == 1 ? 0.8 : 2.1));
    EXPECT_GT(sharesOf(scene).flakes_found, 0.85) << every;
    EXPECT_LT(sharesOf(scene).surfaces_lost, 0.01) << every;
  }
}

TEST(PointTrust, BelievesTheSensorsOwnRainLabelAndTheFirstOfTwoEchoes) {
  const auto doubtOf = [](const std::function<void(LidarCloud&)>& change) {
    Scene scene = sceneOf(0, 1);
    scene.add({6, 0, 0.2}, 0.3F, Source::kFlake);
    scene.add({12, 0, 0.4}, 0.5F, Source::kWall);
    change(scene.cloud());
    TrustParams params;
    params.adapt_share = params.use_intensity = false;
    makePointTrust(params)->apply(scene.frame);
    return 1 - scene.cloud().trust[scene.sources.size() - 2];
  };
  const float plain = doubtOf([](LidarCloud&) {});
  const float labeled = doubtOf([](LidarCloud& c) {
    c.label.assign(c.size(), static_cast<std::uint8_t>(PointLabel::kUnknown));
    c.label[c.size() - 2] = static_cast<std::uint8_t>(PointLabel::kRain);
  });
  const float first_echo = doubtOf([](LidarCloud& c) {
    c.echo.assign(c.size(), 0);
    c.echo.back() = 1;
  });
  const float brighter = doubtOf([](LidarCloud& c) {
    c.echo.assign(c.size(), 0);
    c.echo.back() = 1;
    c.intensity[c.size() - 2] = 0.9F;
  });
  EXPECT_GT(labeled, plain);
  EXPECT_GT(first_echo, plain);
  EXPECT_FLOAT_EQ(brighter, plain);
}

TEST(PointTrust, ReturnsThatAreNoNumbersAreHarmless) {
  const auto trust = makePointTrust({});
  Scene scene = sceneOf(0.02, 1);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::size_t count = scene.cloud().size();
  scene.cloud().x[count / 2] = nan;
  scene.cloud().z[count / 3] = std::numeric_limits<float>::infinity();
  trust->apply(scene.frame);
  for (const float t : scene.cloud().trust) EXPECT_TRUE(t >= 0 && t <= 1);
}

TEST(PointTrust, EmptyScansAndOtherFramesAreLeftAlone) {
  const auto trust = makePointTrust({});
  SensorFrame empty;
  empty.data = LidarCloud{};
  EXPECT_EQ(trust->apply(empty).returns, 0U);
  SensorFrame radar;
  radar.data = RadarReturns{};
  EXPECT_EQ(trust->apply(radar).returns, 0U);
}

TEST(PointTrust, SameScansGiveTheSameTrust) {
  const auto a = makePointTrust({}), b = makePointTrust({});
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    Scene first = sceneOf(0.05, seed), second = sceneOf(0.05, seed);
    a->apply(first.frame), b->apply(second.frame);
    EXPECT_EQ(first.cloud().trust, second.cloud().trust);
  }
}

TEST(IntensityLaw, TellsBinsThatPhantomsHaveMoreOften) {
  IntensityLaw law;
  for (int i = 0; i < 1000; ++i) {
    law.add(IntensityLaw::binOf(0), 1, 0);
    law.add(IntensityLaw::binOf(0.3F), 0, 1);
  }
  const auto ratios = law.logRatios();
  EXPECT_GT(ratios[IntensityLaw::binOf(0)], 2);
  EXPECT_LT(ratios[IntensityLaw::binOf(0.3F)], -2);
  EXPECT_FLOAT_EQ(ratios[IntensityLaw::binOf(1)], 0) << "nothing is known of it";
}

TEST(TrustCurve, GoesThroughItsKnots) {
  const TrustCurve curve({0, 1, 4}, {2, 0, -3});
  EXPECT_NEAR(curve.at(0), 2, 0.02);
  EXPECT_NEAR(curve.at(1), 0, 0.02);
  EXPECT_NEAR(curve.at(2.5F), -1.5, 0.02);
  EXPECT_NEAR(curve.at(9), -3, 1e-6);
  EXPECT_NEAR(curve.at(-9), 2, 1e-6);
}

TEST(WeatherParams, UnknownFilterIsAConfigurationFault) {
  Config config = Config::fromText("[weather]\nfilter = sieve\n");
  WeatherParams::read(config);
  EXPECT_THROW(config.finish(), ConfigError);
}

TEST(WeatherParams, TheFilterIsTrustOrOff) {
  for (const char* name : {"off", "trust"}) {
    Config config = Config::fromText(std::string("[weather]\nfilter = ") + name + "\n");
    const WeatherParams params = WeatherParams::read(config);
    config.finish();
    EXPECT_EQ(makePointFilter(params) == nullptr, name == std::string("off"));
  }
}

TEST(PointFilter, TrustsEachReturnBetweenZeroAndOneAndCountsPhantoms) {
  WeatherParams params;
  params.filter = "trust";
  const auto filter = makePointFilter(params);
  Scene scene = sceneOf(0.02, 3);
  const TrustStats stats = filter->apply(scene.frame);
  ASSERT_EQ(scene.cloud().trust.size(), scene.cloud().size());
  std::size_t doubted = 0;
  for (const float t : scene.cloud().trust) {
    ASSERT_TRUE(t >= 0 && t <= 1);
    doubted += t < 0.5F;
  }
  EXPECT_EQ(stats.phantoms, doubted);
  EXPECT_EQ(stats.returns, scene.cloud().size());
  EXPECT_GT(sharesOf(scene).flakes_found, 0.5);
}

}  // namespace
}  // namespace perception
