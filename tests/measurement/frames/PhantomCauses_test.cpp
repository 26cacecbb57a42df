#include "libperception/measurement/frames/PhantomCauses.h"

#include <gtest/gtest.h>

#include <memory>

namespace perception {
namespace {

TEST(PhantomCauses, InClearAirThereIsNone) {
  const PhantomCauses causes;
  EXPECT_FALSE(causes.any());
  EXPECT_EQ(causes.at({5, 0}, Stamp{}).likelier(), 0);
}

TEST(PhantomCauses, TheWeatherIsEverywhere) {
  PhantomCauses causes;
  causes.weather = 0.7;
  EXPECT_TRUE(causes.any());
  EXPECT_EQ(causes.at({5, 0}, Stamp{}).likelier(), 0.7);
}

TEST(PhantomCauses, AWakeIsWhereAVehicleWasAndIsNoMore) {
  auto wakes = std::make_shared<WakeMap>();
  VehicleFootprint car;
  car.speed = 20, car.half_length = 2.3, car.half_width = 0.9;
  for (int k = 0; k <= 10; ++k) {
    car.stamp = Stamp::fromSeconds(1000 + 0.1 * k);
    car.center = {2.0 * k, 0};
    wakes->add(car);
  }
  PhantomCauses causes;
  causes.wakes = wakes;
  EXPECT_TRUE(causes.any());
  const Stamp now = Stamp::fromSeconds(1001);
  EXPECT_GT(causes.at({10, 0}, now).wake, 0.5) << "half a second ago";
  EXPECT_EQ(causes.at({20, 0}, now).wake, 0) << "the vehicle itself";
  EXPECT_EQ(causes.at({10, 9}, now).wake, 0);
  EXPECT_EQ(causes.at({10, 0}, now + 5.0).wake, 0) << "long ago";
}

}  // namespace
}  // namespace perception
