#include "libperception/measurement/frames/WakeMap.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

/// A car of 4.5 m x 1.8 m at 20 m/s along x, seen at 10 Hz for three seconds: then at x = 60 m.
WakeMap wakeOfACar() {
  WakeMap wakes;
  for (int k = 0; k <= 30; ++k) {
    VehicleFootprint car;
    car.stamp = Stamp::fromSeconds(0.1 * k);
    car.center = {2.0 * k, 0};
    car.speed = 20, car.advanced = 2;
    car.half_length = 2.25, car.half_width = 0.9;
    wakes.add(car);
  }
  return wakes;
}

TEST(WakeMap, APlaceIsAsOldAsTheLastVehicleThatWasThere) {
  const WakeMap wakes = wakeOfACar();
  const auto age = wakes.age({40, 0}, Stamp::fromSeconds(3));
  ASSERT_TRUE(age);
  EXPECT_NEAR(*age, 0.9, 0.06);  // the rear, 2.25 m behind the center, left it at 2.11 s
  EXPECT_FALSE(wakes.age({64, 0}, Stamp::fromSeconds(3))) << "ahead of the car";
  EXPECT_FALSE(wakes.age({50, 0}, Stamp::fromSeconds(2))) << "as was known then";
  EXPECT_NEAR(wakes.age({60, 0}, Stamp::fromSeconds(3)).value_or(-1), 0, 1e-9) << "on the car";
}

TEST(WakeMap, AVehicleFasterThanItsLengthPerScanLeavesNoHole) {
  WakeMap wakes;
  for (int k = 0; k <= 10; ++k) {
    VehicleFootprint car;
    car.stamp = Stamp::fromSeconds(0.1 * k);
    car.center = {2.5 * k, 0};
    car.speed = 25, car.advanced = k > 0 ? 2.5 : 0;
    car.half_length = 1.1, car.half_width = 0.9;  // its rear half alone is seen
    wakes.add(car);
  }
  const Stamp now = Stamp::fromSeconds(1);
  double before = 2;
  for (double x = 0; x < 18; x += 0.1) {
    const auto age = wakes.age({x, 0}, now);
    ASSERT_TRUE(age) << x;
    EXPECT_LE(*age, before + 1e-9) << x;
    EXPECT_NEAR(*age, 1 - (x + 1.1) / 25, 0.1) << x << ": since its rear left";
    before = *age;
  }
}

TEST(WakeMap, AVehicleCameByBehindItsFirstFootprint) {
  VehicleFootprint car;
  car.speed = 20, car.came = 20;
  car.half_length = 2.25, car.half_width = 0.9;
  WakeMap wakes;
  wakes.add(car);
  const Stamp now = Stamp::fromSeconds(0.5);
  EXPECT_TRUE(wakes.cameBy({-10, 0}, now));
  EXPECT_FALSE(wakes.hasLeft({-10, 0}, now)) << "nothing was seen there";
  EXPECT_FALSE(wakes.cameBy({-23, 0}, now)) << "farther back than that";
  EXPECT_FALSE(wakes.cameBy({-10, 3}, now)) << "beside";
  EXPECT_FALSE(wakes.cameBy({10, 0}, now)) << "ahead";
  EXPECT_FALSE(wakes.age({-10, 0}, now)) << "no wake of phantoms that were counted";
  EXPECT_TRUE(wakes.cameBy({-10, 0}, car.stamp)) << "at once";
  EXPECT_FALSE(wakes.cameBy({-10, 0}, car.stamp + -0.1)) << "as was known before it was seen";
  VehicleFootprint next = car;
  next.stamp = now, next.center = {-10, 0}, next.came = 0;
  wakes.add(next);
  EXPECT_FALSE(wakes.cameBy({-10, 0}, now)) << "another vehicle is there now";
}

TEST(WakeMap, IsTheSameAnywhereInTheWorld) {
  const WakeMap here = wakeOfACar();
  const Stamp now = Stamp::fromSeconds(3);
  for (const Vector2& off : {Vector2(-1001.3, 2.9), Vector2(500123.7, -4.1), Vector2(-3.9, 7e6)}) {
    WakeMap there;
    for (int k = 0; k <= 30; ++k) {
      VehicleFootprint car;
      car.stamp = Stamp::fromSeconds(0.1 * k);
      car.center = Vector2(2.0 * k, 0) + off;
      car.speed = 20, car.advanced = 2;
      car.half_length = 2.25, car.half_width = 0.9;
      there.add(car);
    }
    for (double x = -10; x < 75; x += 0.7)
      for (double y = -6; y < 6; y += 0.7)
        EXPECT_NEAR(there.age(Vector2(x, y) + off, now).value_or(-1),
                    here.age({x, y}, now).value_or(-1), 1e-6)
            << x << ", " << y;
  }
}

TEST(WakeMap, WidensWithAgeAndEnds) {
  const WakeMap wakes = wakeOfACar();
  EXPECT_FALSE(wakes.age({58, 1.6}, Stamp::fromSeconds(3)));  // 0.9 + 0.5 m
  EXPECT_TRUE(wakes.age({30, 1.6}, Stamp::fromSeconds(3)));   // and 0.7 m/s
  EXPECT_FALSE(wakes.age({30, 3.5}, Stamp::fromSeconds(3)));
  EXPECT_FALSE(wakes.age({4, 0}, Stamp::fromSeconds(3))) << "2.7 s ago";
  WakeMap later = wakes;
  later.advance(Stamp::fromSeconds(6));
  EXPECT_TRUE(later.empty());
}

TEST(WakeMap, ItsAreaIsThatOfTheWayAndTheWidth) {
  // 26 footprints of the last 2.5 s, 2 m of way each; the mean width is 2.8 m + 1.4 m/s * 1.25 s.
  EXPECT_NEAR(wakeOfACar().area(Stamp::fromSeconds(3)), 26 * 2 * (2.8 + 1.4 * 1.25), 0.5);
}

TEST(WakeMap, PhantomsAreSeenByLidarsAndFade) {
  EXPECT_GT(WakeMap::detection(Modality::kLidar, 0.2), WakeMap::detection(Modality::kLidar, 1));
  EXPECT_LT(WakeMap::detection(Modality::kCamera, 0.2), 0.05);
  EXPECT_LT(WakeMap::detection(Modality::kRadar, 0.2), 0.05);
}

}  // namespace
}  // namespace perception
