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

TEST(PhantomCauses, ACloudIsInItsSectorAndNearTheSensor) {
  auto clouds = std::make_shared<AirClouds>();
  clouds->T_sensor_world = makePose(100, 50, 1.7, kPi / 2).inverse();
  clouds->probability[AirClouds::kSectors / 2] = 0.9;  // 0 to 15 deg to the left of its x
  PhantomCauses causes;
  causes.weather = 0.1;
  causes.clouds = clouds;
  EXPECT_TRUE(causes.any());
  EXPECT_EQ(causes.at({99, 60}, Stamp{}).cloud, 0.9) << "10 m ahead of the sensor";
  EXPECT_TRUE(causes.at({99, 60}, Stamp{}).inCloud());
  EXPECT_EQ(causes.at({99, 60}, Stamp{}).likelier(), 0.9);
  EXPECT_EQ(causes.at({101, 60}, Stamp{}).cloud, 0) << "to its right";
  EXPECT_EQ(causes.at({101, 60}, Stamp{}).likelier(), 0.1) << "the weather alone";
  EXPECT_EQ(causes.at({98, 75}, Stamp{}).cloud, 0) << "25 m ahead";
  causes.weather = 1;
  EXPECT_FALSE(causes.at({99, 60}, Stamp{}).inCloud()) << "fog is everywhere";
}

TEST(PhantomCauses, SprayElsewhereIsNoCauseForTheSafetyGrid) {
  PhantomCauses causes;
  causes.spray = 0.8;
  EXPECT_FALSE(causes.any());
  EXPECT_EQ(causes.at({5, 0}, Stamp{}).spray, 0.8);
  EXPECT_EQ(causes.at({5, 0}, Stamp{}).likelier(), 0);
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
