#include "libperception/pipeline/phantoms/WeatherWatch.h"

#include <gtest/gtest.h>

#include "libperception/core/Csv.h"
#include "tests/support/StartStamp.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

using test::kStart;

AirCensus air(double drops) {
  AirCensus census;
  for (auto& sector : census.sectors)
    sector.returns = 4000, sector.level = 400, sector.lone[0] = drops * sector.returns;
  census.ground[5] = 48000, census.upright[30] = 48000;
  return census;
}

/// Two seconds of clear air, four of rain, ten of clear air.
void pass(WeatherWatch& watch) {
  TrustStats trust;
  trust.returns = 96000, trust.phantoms = 50, trust.mirrored = 8;
  for (int k = 0; k < 160; ++k)
    watch.add("LIDAR", kStart + 0.1 * k, air(k >= 20 && k < 60 ? 30e-4 : 0), trust);
}

TEST(WeatherWatch, EachChangeOfTheTypeIsOneEvent) {
  EventLog events;
  WeatherWatch watch(events);
  pass(watch);
  EXPECT_EQ(events.counts().at(event_kind::kWeather), 2U);
  const std::string text = events.text(kStart);
  const auto rain = text.find("LIDAR: rain"), clear = text.find("LIDAR: clear");
  ASSERT_NE(rain, std::string::npos);
  ASSERT_NE(clear, std::string::npos);
  EXPECT_LT(rain, clear);
  EXPECT_EQ(events.warnings(), 0U);
}

TEST(WeatherWatch, ClearAirIsNoEvent) {
  EventLog events;
  WeatherWatch watch(events);
  for (int k = 0; k < 50; ++k) watch.add("LIDAR", kStart + 0.1 * k, air(0), {});
  EXPECT_TRUE(events.counts().empty());
}

TEST(WeatherWatch, LidarsThatDisagreeMeetInTheMiddle) {
  EventLog events;
  WeatherWatch watch(events);
  for (int k = 0; k < 40; ++k) {
    watch.add("A", kStart + 0.1 * k, air(30e-4), {});
    watch.add("B", kStart + 0.1 * k, air(0), {});
  }
  EXPECT_NEAR(watch.probabilities()[0], 0.5, 0.02);
  EXPECT_TRUE(events.counts().empty());
}

TEST(WeatherWatch, TheFileHasALineAScanWithWhatWasDoubted) {
  EventLog events;
  WeatherWatch watch(events);
  pass(watch);
  const test::TemporaryFolder folder;
  WeatherFile file(folder / "weather.csv", kStart);
  for (const WeatherRow& row : watch.take()) file.write(row);
  file.close();
  EXPECT_TRUE(watch.take().empty());
  const CsvTable table = CsvTable::fromFile(folder / "weather.csv");
  ASSERT_EQ(table.rows(), 160U);
  EXPECT_EQ(table.text(0, table.column("type")), "clear");
  EXPECT_EQ(table.text(59, table.column("type")), "rain");
  EXPECT_NEAR(table.real(59, table.column("t")), 5.9, 1e-9);
  EXPECT_EQ(table.natural(0, table.column("doubted")), 42U);
  EXPECT_EQ(table.natural(0, table.column("mirrored")), 8U);
  double sum = 0;
  for (const char* p : {"p_clear", "p_rain", "p_snow", "p_fog"})
    sum += table.real(59, table.column(p));
  EXPECT_NEAR(sum, 1, 1e-5);
}

}  // namespace
}  // namespace perception
