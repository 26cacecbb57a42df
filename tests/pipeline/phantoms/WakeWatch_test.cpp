#include "libperception/pipeline/phantoms/WakeWatch.h"

#include <gtest/gtest.h>

#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

ClassTable carsAlone() {
  ClassTable table = test::linearClasses();
  table.classes.resize(1);
  table.classes[0].name = "car";
  table.classes[0].shape = ObjectShape::kVehicle;
  return table;
}

/// A lidar's watch of a car at 20 m/s along x.
struct World {
  ClassTable classes = carsAlone();
  std::vector<PipelineSetup::Sensor> sensors = std::vector<PipelineSetup::Sensor>(2);
  WakeWatch watch{sensors, classes};
  double clutter_per_scan = sensors[0].params.clutter_per_scan;

  MeasurementScan scanAt(double t, const std::vector<Vector2>& phantoms) const {
    MeasurementScan scan;
    scan.state.stamp = Stamp::fromSeconds(1000 + t);
    scan.verdicts.emplace();
    for (const Vector2& center : phantoms) {
      PhantomCluster phantom;
      phantom.center = center;
      scan.verdicts->phantoms.push_back(phantom);
    }
    return scan;
  }
  static Hypothesis carAt(double t, double speed) {
    Track car;
    car.birth = Stamp::fromSeconds(999);
    car.stamp = Stamp::fromSeconds(1000 + t);
    car.existence = 0.99;
    car.hits = {10};
    car.log_class = {0};
    car.bank.resize(1);
    car.bank[0].x = Vector4(speed * t, 0, speed, 0);
    car.bank[0].extent.length = 4.5, car.bank[0].extent.width = 1.8;
    return Hypothesis(TrackTable{std::make_shared<const Track>(car)});
  }
  /// The scan at 2 s as it goes into the filter, of sensor `sensor`.
  MeasurementScan after(double speed, const std::vector<Vector2>& phantoms,
                        std::size_t sensor = 0) {
    for (int k = 0; k < 20; ++k) watch.add(0, scanAt(0.1 * k, phantoms), carAt(0.1 * k, speed));
    MeasurementScan scan = scanAt(2, {});
    watch.apply(sensor, scan, clutter_per_scan);
    return scan;
  }
};

TEST(WakeWatch, PhantomsBehindAVehicleMakeItsWakeOneOfPhantoms) {
  const MeasurementScan scan = World().after(20, {{10, 0}});
  ASSERT_TRUE(scan.wakes);
  EXPECT_GT(scan.wakes->density, 1);
  EXPECT_TRUE(scan.wakes->age({30, 0}, scan.state.stamp));
}

// The filter multiplies the density of clutter by one more than this: where that is learned to be
// ten times the configured one, phantoms are no more frequent for it.
TEST(WakeWatch, PhantomsAreAsFrequentWhateverTheClutter) {
  const double few = World().after(20, {{10, 0}}).wakes->density;
  World loud;
  loud.clutter_per_scan *= 10;
  EXPECT_NEAR(loud.after(20, {{10, 0}}).wakes->density, few / 10, 1e-9 * few);
}

TEST(WakeWatch, ALostVehicleLeavesAWakeWhereItMustHaveGoneButNotForTheGrid) {
  World world;
  world.after(20, {{10, 0}});
  for (int k = 20; k < 30; ++k) world.watch.add(0, world.scanAt(0.1 * k, {}), Hypothesis());
  MeasurementScan scan = world.scanAt(3, {});
  world.watch.apply(0, scan, world.clutter_per_scan);
  ASSERT_TRUE(scan.wakes);
  EXPECT_TRUE(scan.wakes->cameBy({49, 0}, scan.state.stamp));
  EXPECT_FALSE(scan.wakes->cameBy({60, 0}, scan.state.stamp)) << "it is not there yet";
  EXPECT_FALSE(scan.wakes->cameBy({50, 4}, scan.state.stamp)) << "beside";
  EXPECT_FALSE(world.watch.at(scan.state.stamp)->cameBy({49, 0}, scan.state.stamp));
  for (int k = 30; k < 80; ++k) world.watch.add(0, world.scanAt(0.1 * k, {}), Hypothesis());
  MeasurementScan later = world.scanAt(8, {});
  world.watch.apply(0, later, world.clutter_per_scan);
  EXPECT_FALSE(later.wakes && later.wakes->cameBy({100, 0}, later.state.stamp));
}

// Drawn back into its cloud it seems slow in the end.
TEST(WakeWatch, ALostVehicleGoesOnAsItDroveAllTheTime) {
  World world;
  world.after(20, {{10, 0}});
  Track car = *World::carAt(1.9, 20).tracks[0];
  car.bank[0].x = Vector4(39, 0, 8, 3), car.stamp = Stamp::fromSeconds(1002);
  world.watch.add(0, world.scanAt(2, {}), Hypothesis(TrackTable{std::make_shared<Track>(car)}));
  for (int k = 21; k < 30; ++k) world.watch.add(0, world.scanAt(0.1 * k, {}), Hypothesis());
  MeasurementScan scan = world.scanAt(3, {});
  world.watch.apply(0, scan, world.clutter_per_scan);
  EXPECT_TRUE(scan.wakes->cameBy({53, 0}, scan.state.stamp));
}

TEST(WakeWatch, AVehicleThatBecomesSlowIsNotLost) {
  World world;
  world.after(20, {{10, 0}});
  for (int k = 20; k < 30; ++k) world.watch.add(0, world.scanAt(0.1 * k, {}), World::carAt(2, 4));
  MeasurementScan scan = world.scanAt(3, {});
  world.watch.apply(0, scan, world.clutter_per_scan);
  EXPECT_FALSE(scan.wakes->cameBy({49, 0}, scan.state.stamp));
}

TEST(WakeWatch, PhantomsWhereAVehicleMustHaveComeAreSeenInItsWake) {
  World world;
  world.watch.add(0, world.scanAt(0, {{-10, 0}}), World::carAt(0, 20));
  MeasurementScan scan = world.scanAt(0.1, {});
  world.watch.apply(0, scan, world.clutter_per_scan);
  ASSERT_TRUE(scan.wakes);
  EXPECT_GT(scan.wakes->density, 0);
}

/// Whether a car in its second scan leaves a wake, with that deviation [m/s] of its speed.
bool newbornHasAWake(double sigma) {
  World world;
  Track car = *World::carAt(0.1, 20).tracks[0];
  car.birth = Stamp::fromSeconds(1000);
  car.hits = {2};
  car.bank[0].P(2, 2) = car.bank[0].P(3, 3) = sigma * sigma;
  world.watch.add(0, world.scanAt(0.1, {}), Hypothesis(TrackTable{std::make_shared<Track>(car)}));
  return world.watch.at(Stamp::fromSeconds(1000.1)) != nullptr;
}

TEST(WakeWatch, ANewbornVehicleHasAWakeOnceItsSpeedIsKnown) {
  EXPECT_TRUE(newbornHasAWake(1));
  EXPECT_FALSE(newbornHasAWake(3));
}

TEST(WakeWatch, InClearAirThereAreNoWakes) {
  EXPECT_FALSE(World().after(20, {}).wakes);
  EXPECT_FALSE(World().after(20, {{10, 8}}).wakes) << "phantoms beside the way of the car";
}

TEST(WakeWatch, ASlowVehicleHasNone) { EXPECT_FALSE(World().after(4, {{2, 0}}).wakes); }

TEST(WakeWatch, ASensorThatSawNoPhantomsStartsNone) {
  const MeasurementScan scan = World().after(20, {{10, 0}}, 1);
  ASSERT_TRUE(scan.wakes);
  EXPECT_EQ(scan.wakes->density, 0);
}

TEST(WakeWatch, PhantomsInWakesSayThatVehiclesThrowUpSpray) {
  const Stamp now = Stamp::fromSeconds(1002);
  World wet, dry, beside;
  wet.after(20, {{10, 0}}), dry.after(20, {}), beside.after(20, {{10, 8}});
  EXPECT_GT(wet.watch.spray(0, now), 0.7);
  EXPECT_EQ(wet.watch.spray(1, now), 0) << "a sensor that saw none";
  EXPECT_LT(wet.watch.spray(0, Stamp::fromSeconds(1032)), 0.5) << "half a minute later";
  EXPECT_EQ(dry.watch.spray(0, now), 0);
  EXPECT_EQ(beside.watch.spray(0, now), 0);
}

TEST(WakeWatch, ARestartForgetsTheWakes) {
  World world;
  world.after(20, {{10, 0}});
  world.watch.restart();
  MeasurementScan scan = world.scanAt(2, {});
  world.watch.apply(0, scan, world.clutter_per_scan);
  EXPECT_FALSE(scan.wakes);
}

}  // namespace
}  // namespace perception
