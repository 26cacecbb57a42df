#include "libperception/pipeline/watches/ConditionWatch.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/Random.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

using test::exactModel;
using test::linearClasses;
using test::linearSensor;
using test::positionScan;

constexpr double kTrueClutter = 3;  // a scan

/// A filter and its watch: a disc of 40 m with five poles and clutter, seen at 10 Hz.
struct WatchedWorld {
  std::vector<PipelineSetup::Sensor> sensors;
  EventLog events;
  WeatherWatch weather{events};
  PositionModel::Params params = linearSensor();

  explicit WatchedWorld(DetectionParams::Clutter clutter, double configured) {
    params.clutter_per_scan = configured;
    params.births_per_scan = 0.1;
    PipelineSetup::Sensor sensor;
    sensor.label = "POSITION";
    sensor.active = true;
    sensor.params.clutter = clutter;
    sensor.params.clutter_per_scan = configured;
    sensor.params.range_max = params.range;
    sensors = {sensor};
  }

  /// The learned rate after `seconds`; `last`: the last scan as it went into the filter.
  double run(double seconds, MeasurementScan* last = nullptr) {
    FilterModel model = exactModel(linearClasses());
    model.proposal = Proposal::kRanked;
    model.params.existence_max = 0.999, model.params.existence_min = 0.002;
    CRbpfTracker tracker(model, ParticleFilterParams{}.toMrpt(), 1);
    ConditionWatch watch(sensors, weather);
    const auto sensor = std::make_shared<const PositionModel>(params);
    Rng rng({3, 0, 0, 0});
    for (int k = 0; k < 10 * seconds; ++k) {
      std::vector<test::LabeledPoint> points;
      for (int i = 0; i < 5; ++i)
        if (rng.uniform() < 0.6) points.push_back({6.0 * i - 12, 5, 1});
      for (int n = rng.poisson(kTrueClutter); n > 0; --n) {
        const double range = params.range * std::sqrt(rng.uniform());
        const double bearing = kTwoPi * rng.uniform();
        points.push_back({range * std::cos(bearing), range * std::sin(bearing), 0});
      }
      MeasurementScan scan = positionScan(sensor, 0.1 * k, points);
      watch.apply(0, scan);
      const auto index = tracker.scans();
      EXPECT_TRUE(tracker.process(scan));
      watch.add(0, scan, tracker, index);
      if (last) *last = scan;
    }
    learned = watch.learned();
    rate = watch.clutterRate(0);
    return watch.clutter(0)->rate();
  }
  std::vector<std::string> learned;
  double rate = 0;  ///< by which scans are judged
};

TEST(ConditionWatch, ClutterMissetByTenEitherWayIsLearnedInTwentySeconds) {
  for (const double configured : {0.3, 3.0, 30.0}) {
    WatchedWorld world(DetectionParams::Clutter::kLearnt, configured);
    EXPECT_NEAR(world.run(20), kTrueClutter, 0.6) << configured;
    EXPECT_NEAR(world.rate, kTrueClutter, 0.6) << configured;
    ASSERT_EQ(world.learned.size(), 2U);
    EXPECT_EQ(world.learned[0], "[sensor.POSITION]");
  }
}

TEST(ConditionWatch, FixedClutterStaysInTheModel) {
  WatchedWorld world(DetectionParams::Clutter::kFixed, 30);
  MeasurementScan last;
  world.run(5, &last);
  EXPECT_NE(last.model->positionOnly(), nullptr);
  const Measurement& m = last.measurements.front();
  EXPECT_NEAR(last.model->logClutterDensity(m, last.state), std::log(30 / (kPi * 40 * 40)), 1e-9);
  EXPECT_TRUE(world.learned.empty());
  EXPECT_EQ(world.rate, 30);
}

TEST(ConditionWatch, LearnedClutterIsInTheModelOfTheScan) {
  WatchedWorld world(DetectionParams::Clutter::kLearnt, 30);
  MeasurementScan last;
  world.run(20, &last);
  const Measurement& m = last.measurements.front();
  EXPECT_LT(last.model->logClutterDensity(m, last.state), std::log(10 / (kPi * 40 * 40)));
}

/// Share of P_D that a camera's scan goes into the filter with, of eight of twenty objects seen.
double shareOfCamera(std::vector<Modality> others, bool rain_told = false) {
  std::vector<PipelineSetup::Sensor> sensors;
  others.insert(others.begin(), Modality::kCamera);
  for (const Modality modality : others) {
    PipelineSetup::Sensor sensor;
    sensor.active = true, sensor.params.modality = modality;
    sensors.push_back(sensor);
  }
  EventLog events;
  WeatherWatch weather{events};
  AirCensus rain;
  for (auto& sector : rain.sectors)
    sector.returns = 4000, sector.level = 400, sector.lone[0] = 0.003 * sector.returns;
  rain.ground[5] = 48000, rain.upright[30] = 48000;
  for (int k = 0; rain_told && k < 40; ++k)
    weather.add("LIDAR", Stamp::fromSeconds(1000 + 0.1 * k), rain, {});
  MeasurementScan scan =
      positionScan(std::make_shared<const PositionModel>(linearSensor()), 0, {{3, 5, 1}});
  return ConditionWatch(sensors, weather).apply(0, scan, DetectionCount{20, 8});
}

TEST(ConditionWatch, CameraWithRadarsHasTheShareOfDetectionsThatItShows) {
  EXPECT_NEAR(shareOfCamera({Modality::kRadar}), (0.6 * 4 + 8) / (4 + 20), 1e-12);
}

TEST(ConditionWatch, CameraKeepsItsDetectionProbabilityWhereALidarSeesClearAir) {
  EXPECT_EQ(shareOfCamera({Modality::kRadar, Modality::kLidar}), 1);
  EXPECT_LT(shareOfCamera({Modality::kRadar, Modality::kLidar}, true), 0.5);
}

TEST(ConditionWatch, CameraAloneKeepsItsDetectionProbability) { EXPECT_EQ(shareOfCamera({}), 1); }

}  // namespace
}  // namespace perception
