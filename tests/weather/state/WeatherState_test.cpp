#include "libperception/weather/state/WeatherState.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

/// A street: every sector returns to 60 m, level beams, too.
AirCensus street() {
  AirCensus census;
  for (auto& sector : census.sectors) sector.returns = 4000, sector.level = 400;
  census.ground[5] = 48000, census.ground[20] = 2000;
  census.upright[8] = 40000, census.upright[30] = 6000;
  return census;
}

/// Lone returns in each sector by shell, as shares of its returns.
AirCensus with(std::array<double, AirCensus::kShellCount> shares) {
  AirCensus census = street();
  for (auto& sector : census.sectors)
    for (std::size_t k = 0; k < shares.size(); ++k) sector.lone[k] = shares[k] * sector.returns;
  return census;
}

WeatherState after(const AirCensus& census, double seconds, double rate = 10) {
  WeatherEstimator estimator;
  const Stamp first{1'000'000'000};
  for (int k = 0; k <= seconds * rate; ++k) estimator.add(census, first + k / rate);
  return estimator.state();
}

TEST(WeatherState, AStreetInClearAirIsClear) {
  const WeatherState state = after(street(), 5);
  EXPECT_EQ(state.type(), WeatherType::kClear);
  EXPECT_GT(state.of(WeatherType::kClear), 0.99);
  EXPECT_NEAR(state.rain_mm_h.value, 0, 0.05);
}

TEST(WeatherState, DropsAllAroundAreRainAfterASecond) {
  const WeatherState state = after(with({20e-4, 5e-4, 0, 0, 0}), 1);
  EXPECT_EQ(state.type(), WeatherType::kRain);
  EXPECT_GT(state.of(WeatherType::kRain), 0.9);
  EXPECT_GT(state.rain_mm_h.value, 0.5);
}

/// Rain that 1 % of the open level beams meet from 1.5 to 4 m; `blocked`: [0, 1] of all level
/// beams.
AirCensus rain(double blocked) {
  AirCensus census = with({20e-4 * (1 - blocked), 5e-4 * (1 - blocked), 0, 0, 0});
  census.max_range = 120;
  for (auto& sector : census.sectors) {
    sector.below = 400, sector.blocked = 400 * blocked;
    sector.level_lone = {3 * (1 - blocked), (1 - blocked), 0, 0, 0};
  }
  return census;
}

// A log has no pulse without a return: how many of them look into the open is told by the beams
// below the horizon.
TEST(WeatherState, TheRateOfRainIsTheSameInAStreetAndOnAPlain) {
  const double plain = after(rain(0), 10).rain_mm_h.value;
  EXPECT_NEAR(plain, 3.43, 0.05);
  EXPECT_NEAR(after(rain(0.7), 10).rain_mm_h.value, plain, 0.1);
}

TEST(WeatherState, SprayInAThirdOfTheDirectionsIsNoHeavierRain) {
  AirCensus census = rain(0);
  for (std::size_t s = 0; s < 8; ++s) census.sectors[s].level_lone = {60, 60, 60, 60, 60};
  EXPECT_NEAR(after(census, 10).rain_mm_h.value, after(rain(0), 10).rain_mm_h.value, 0.1);
}

TEST(WeatherState, ReturnsThatEndWithinFourMetersAreDropsWhatPlantsDoBesideTheRoad) {
  AirCensus census = rain(0);
  for (auto& sector : census.sectors) sector.lone = {4, 2, 6, 6, 6};  // most below the horizon
  EXPECT_NEAR(after(census, 10).rain_mm_h.value, after(rain(0), 10).rain_mm_h.value, 0.1);
  for (auto& sector : census.sectors) sector.level_lone = {0.3, 0.3, 0.3, 0.2, 0.1};
  EXPECT_NEAR(after(census, 10).rain_mm_h.value, 12.0 / 4000 / (1.69e-4 * 0.597), 0.1);
}

TEST(WeatherState, FlakesInEveryBeamAreJudgedByTheirBrightness) {
  const auto snow = [](double brightness) {
    AirCensus census = with({40e-4, 40e-4, 60e-4, 90e-4, 60e-4});
    for (auto& sector : census.sectors) {
      sector.below = 400, sector.level_lone = {40, 40, 60, 60, 60};
      sector.brightness = 40 * brightness, sector.lit = 40;
    }
    return after(census, 10).snow_mm_h.value;
  };
  EXPECT_NEAR(snow(0.124), 1, 0.02);
  EXPECT_NEAR(snow(0.233), 4, 0.1);
}

TEST(WeatherState, ManyReturnsUpToTenMetersAreSnow) {
  EXPECT_EQ(after(with({10e-4, 20e-4, 40e-4, 80e-4, 40e-4}), 1).type(), WeatherType::kSnow);
}

TEST(WeatherState, PlantsInThreeQuartersOfTheSectorsAreNoWeather) {
  AirCensus census = with({50e-4, 50e-4, 50e-4, 50e-4, 50e-4});
  for (std::size_t s = 0; s < 7; ++s) census.sectors[s].lone = {};
  EXPECT_EQ(after(census, 5).type(), WeatherType::kClear);
}

TEST(WeatherState, SprayBesideTheVehicleIsACloudInItsSectorsAtOnce) {
  AirCensus census = street();
  census.sectors[5].lone = {0, 0.03 * 4000, 0.05 * 4000, 0.02 * 4000, 0};
  WeatherEstimator estimator;
  estimator.add(street(), Stamp{1'000'000'000});
  EXPECT_EQ(estimator.clouds(Pose3::Identity(), 0), nullptr);
  estimator.add(census, Stamp{1'100'000'000});
  const auto clouds = estimator.clouds(Pose3::Identity(), 0);
  ASSERT_NE(clouds, nullptr);
  EXPECT_GT(clouds->probability[5], 0.9);
  EXPECT_GT(clouds->probability[6], 0.9) << "a cloud fades out";
  EXPECT_EQ(clouds->probability[8], 0);
  EXPECT_GT(estimator.state().of(WeatherType::kClear), 0.9) << "a cloud is no weather";
  EXPECT_EQ(estimator.clouds(Pose3::Identity(), 0.99), nullptr) << "the weather is the likelier";
}

TEST(WeatherState, PlantsAsInClearRecordingsAreNoCloud) {
  AirCensus census = street();
  census.sectors[3].lone = {10e-4 * 4000, 20e-4 * 4000, 60e-4 * 4000, 80e-4 * 4000, 400e-4 * 4000};
  WeatherEstimator estimator;
  estimator.add(census, Stamp{1'000'000'000});
  EXPECT_EQ(estimator.clouds(Pose3::Identity(), 0), nullptr);
}

TEST(WeatherState, OneScanDecidesNothing) {
  EXPECT_EQ(after(with({20e-4, 20e-4, 40e-4, 80e-4, 40e-4}), 0).type(), WeatherType::kClear);
}

/// Nothing returns from beyond 28 m; level beams meet something in three of ten directions.
AirCensus foggy() {
  AirCensus census = street();
  census.ground = {}, census.upright = {};
  census.ground[5] = 30000, census.upright[14] = 9000;
  for (std::size_t s = 0; s < AirCensus::kSectors; ++s)
    census.sectors[s].level = s % 3 == 0 ? 400 : 0;
  return census;
}

TEST(WeatherState, BeamsThatVanishBeyondThirtyMetersAreFog) {
  const WeatherState state = after(foggy(), 2);
  EXPECT_EQ(state.type(), WeatherType::kFog);
  EXPECT_GT(state.visibility.value, 40);
  EXPECT_LT(state.visibility.value, 120);
}

TEST(WeatherState, ANarrowStreetIsNoFog) {
  AirCensus census = foggy();
  for (auto& sector : census.sectors) sector.level = 400;  // walls everywhere
  EXPECT_EQ(after(census, 5).type(), WeatherType::kClear);
}

TEST(WeatherState, AnEmptyFieldIsNoFog) {
  AirCensus census = foggy();
  for (auto& sector : census.sectors) sector.level = 0;
  census.sectors[0].level = 400;
  EXPECT_EQ(after(census, 5).type(), WeatherType::kClear);
}

TEST(WeatherState, DenseReturnsThatEndWithinTenMetersAreFog) {
  AirCensus census = with({150e-4, 800e-4, 550e-4, 450e-4, 10e-4});
  census.ground = {}, census.upright = {};
  census.ground[5] = 50000, census.upright[9] = 40000;
  EXPECT_EQ(after(census, 2).type(), WeatherType::kFog);
}

TEST(WeatherState, WeatherThatEndsIsForgotten) {
  WeatherEstimator estimator;
  const Stamp first{1'000'000'000};
  for (int k = 0; k < 30; ++k) estimator.add(with({20e-4, 5e-4, 0, 0, 0}), first + 0.1 * k);
  EXPECT_EQ(estimator.state().type(), WeatherType::kRain);
  for (int k = 30; k < 150; ++k) estimator.add(street(), first + 0.1 * k);
  EXPECT_EQ(estimator.state().type(), WeatherType::kClear);
}

TEST(WeatherState, RepeatedShowingsOfAScanCountOnce) {
  EXPECT_EQ(after(with({20e-4, 20e-4, 40e-4, 80e-4, 40e-4}), 0.1, 200).type(), WeatherType::kClear);
}

TEST(WeatherState, AFlurryIsThereInItsFirstScan) {
  EXPECT_LT(after(street(), 0.1, 1).notClear(), 0.1);
  const WeatherState snow = after(with({20e-4, 20e-4, 40e-4, 80e-4, 40e-4}), 0.1, 1);
  EXPECT_EQ(snow.type(), WeatherType::kClear) << "one scan does not change the weather";
  EXPECT_GT(snow.notClear(), 0.5);
  EXPECT_LT(after(street(), 2).notClear(), 0.01);
}

}  // namespace
}  // namespace perception
