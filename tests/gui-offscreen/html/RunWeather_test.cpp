#include "gui-offscreen/html/RunWeather.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

/// Ten scans of two lidars, one after the other; the second has doubts and a ledger.
void writeWeather(const std::string& dir) {
  std::ofstream weather(dir + "/weather.csv"), ledger(dir + "/ledger.csv");
  weather << "t,sensor,p_clear,p_rain,p_snow,p_fog,rain,rain_low,rain_high,snow,snow_low,snow_high,"
             "visibility,visibility_low,visibility_high,returns,doubted\n";
  ledger << "t,sensor,clusters,phantom_clusters\n";
  for (int k = 0; k < 10; ++k) {
    for (const char* sensor : {"FRONT", "TOP"}) {
      const bool top = sensor[0] == 'T';
      weather << 0.1 * k << ',' << sensor << ",0.1,0.8,0.05,0.05,9,7,11,,,,900,700,1200,1000,"
              << (top ? 50 : 0) << '\n';
      if (top) ledger << 0.1 * k << ',' << sensor << ',' << 20 + k << ',' << k << '\n';
    }
  }
}

TEST(RunWeather, ScansOfEachLidarAreThinnedEvenly) {
  const test::TemporaryFolder folder;
  writeWeather(folder.path());
  const auto few = weatherOf(folder.path(), 4), all = weatherOf(folder.path());
  ASSERT_EQ(few.size(), 2U);
  EXPECT_EQ(few[0]["sensor"], "FRONT");
  EXPECT_EQ(few[0]["t"].dump(), "[0.0,0.2,0.5,0.7]");
  EXPECT_EQ(few[1]["ledger"]["clusters"].dump(), "[20.0,22.0,25.0,27.0]");
  EXPECT_EQ(few[1]["p"].size(), 4U);
  EXPECT_EQ(few[1]["p"][1].size(), 4U);
  EXPECT_EQ(few[1]["doubted"][0], 0.05);
  EXPECT_TRUE(few[0]["snow"][0][0].is_null()) << "an empty field";
  EXPECT_EQ(few[0]["rain"][2][3], 11);
  EXPECT_FALSE(few[0].contains("ledger"));
  EXPECT_EQ(all[0]["t"].size(), 10U);
}

TEST(RunWeather, ARunWithoutWeatherHasNone) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(weatherOf(folder.path()).empty());
}

}  // namespace
}  // namespace perception
