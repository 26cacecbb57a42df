#include "libperception/filter/likelihood/PhantomOdds.h"

#include <gtest/gtest.h>

#include "libperception/filter/CRbpfTracker.h"
#include "tests/filter/likelihood/RememberingSensor.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

/// A place that a car left at t = 0, seen at 10 Hz: what is there is at `start`, of speed `speed`.
struct WakeWorld {
  FilterModel model = test::exactModel(test::linearClasses());
  PositionModel::Params params = test::linearSensor();
  bool wake = true;
  Modality modality = Modality::kLidar;
  Vector2 start = {10, 5};
  double speed = 0;

  WakeWorld() {
    model.proposal = Proposal::kRanked;
    model.params.existence_max = 0.999, model.params.existence_min = 0.002;
    model.classes.classes[0].max_speed = 20;
    params.classes[0].detection = params.classes[1].detection = 0.8;
    params.clutter_per_scan = 1, params.births_per_scan = 0.1;
  }

  /// P(a real object) after `seconds` of detections by a lidar and one by `modality` at the end.
  double realAfter(double seconds) const {
    CRbpfTracker tracker(model, ParticleFilterParams{}.toMrpt(), 1);
    const auto sensor = std::make_shared<const PositionModel>(params);
    const auto wakes = std::make_shared<WakeMap>();
    VehicleFootprint car;
    car.stamp = Stamp::fromSeconds(1000);
    car.center = {12, 5}, car.half_length = 6, car.half_width = 1;
    wakes->add(car);
    wakes->density = 1000;  // times the clutter
    const int scans = static_cast<int>(10 * seconds);
    for (int k = 1; k <= scans; ++k) {
      const double t = 0.1 * k;
      auto scan = test::positionScan(sensor, t, {{start.x() + speed * t, start.y(), 1}});
      if (k == scans) scan.modality = modality;
      if (scan.modality != Modality::kLidar) wakes->density = 0;
      if (wake) scan.wakes = wakes;
      wakes->advance(scan.state.stamp);
      EXPECT_TRUE(tracker.process(scan));
    }
    double real = 0;
    for (const auto& track : tracker.mapHypothesis().tracks) real = std::max(real, track->real());
    return real;
  }
};

TEST(PhantomOdds, SprayThatHangsInAWakeIsNoObjectAndWithoutTheWakeItIs) {
  WakeWorld world;
  EXPECT_LT(world.realAfter(0.8), 0.3);
  world.wake = false;
  EXPECT_GT(world.realAfter(0.8), 0.95);
}

TEST(PhantomOdds, WhatIsStillThereWhenTheWakeIsOldIsAnObject) {
  EXPECT_GT(WakeWorld().realAfter(3.2), 0.95);
}

TEST(PhantomOdds, WhatACameraOrARadarSeesIsAnObject) {
  for (const Modality modality : {Modality::kCamera, Modality::kRadar}) {
    WakeWorld world;
    const double before = world.realAfter(0.4);
    world.modality = modality;
    EXPECT_GT(world.realAfter(0.5), 5 * before);
  }
}

TEST(PhantomOdds, WhatMovesIsAnObject) {
  WakeWorld world;
  world.speed = 8;
  EXPECT_GT(world.realAfter(0.8), 0.95);
}

/// P(a real object) of what stands at (10, `y`) and is seen for a second, where it becomes known at
/// 0.3 s that a car came by at y = 5.
double realAsAWakeBecomesKnown(double y, int from) {
  const WakeWorld world;
  CRbpfTracker tracker(world.model, ParticleFilterParams{}.toMrpt(), 1);
  const auto sensor = std::make_shared<const PositionModel>(world.params);
  VehicleFootprint car;
  car.stamp = Stamp::fromSeconds(1000.3);
  car.center = {20, 5}, car.half_length = 2, car.half_width = 1;
  car.speed = 20, car.came = 20;
  const auto wakes = std::make_shared<WakeMap>();
  wakes->add(car);
  wakes->density = 1000;
  for (int k = from; k <= 4; ++k) {
    auto scan = test::positionScan(sensor, 0.1 * k, {{10, y, 1}});
    if (k == 4) scan.wakes = wakes;
    EXPECT_TRUE(tracker.process(scan));
  }
  double real = 0;
  for (const auto& track : tracker.mapHypothesis().tracks) real = std::max(real, track->real());
  return real;
}

TEST(PhantomOdds, WhatWasBornInAWakeThatIsKnownOnlyLaterBecomesDoubtfulThen) {
  EXPECT_LT(realAsAWakeBecomesKnown(5, 1), 0.5);
  EXPECT_GT(realAsAWakeBecomesKnown(12, 1), 0.95) << "beside it";
  EXPECT_GT(realAsAWakeBecomesKnown(5, -30), 0.95) << "it stood there for three seconds before";
}

TEST(PhantomOdds, OutsideOfTheWakeNothingChanges) {
  WakeWorld beside, dry;
  beside.start = dry.start = {10, 12};
  dry.wake = false;
  EXPECT_EQ(beside.realAfter(0.5), dry.realAfter(0.5));
}

/// P(a real object) of a track that is born from a cluster and hit by two more, a tenth of a second
/// apart, of which each looks like a phantom by `look`.
double realByShape(const std::optional<PhantomLook>& look) {
  test::RepeatFixture f;
  f.model.params.existence_max = 0.999;
  const auto scanAt = [&](double t) {
    MeasurementScan scan = f.seen(t, test::kAhead, {-1, 0});
    scan.measurements[0].phantom = look;
    return scan;
  };
  Track track = f.born(scanAt(0));
  for (const double t : {0.1, 0.2}) track = f.hit(track, scanAt(t));
  return track.real();
}

TEST(PhantomOdds, WhatLooksLikeSprayWhereSomethingMakesSprayIsNoObject) {
  EXPECT_GT(realByShape(std::nullopt), 0.95) << "no cause, or not told by its shape";
  const double as_spray = realByShape(PhantomLook{0.9, 0.6, 5});
  EXPECT_LT(as_spray, 0.4);
  EXPECT_LT(as_spray, 0.9 * realByShape(PhantomLook{0.9, 0.6, 0})) << "each look counts";
  EXPECT_GT(realByShape(PhantomLook{0.9, 0.01, -3}), 0.95) << "it looks like an object";
}

TEST(PhantomOdds, AShapeMakesNoPhantomWhereHardlyAnythingMakesPhantoms) {
  EXPECT_GT(realByShape(PhantomLook{0.02, 0.02, 6}), 0.97);
}

}  // namespace
}  // namespace perception
