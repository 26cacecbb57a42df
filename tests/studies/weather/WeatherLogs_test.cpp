#include "studies/weather/WeatherLogs.h"

#include <gtest/gtest.h>

#include "libperception/core/Error.h"

namespace perception {
namespace {

const std::string kRoot = PERCEPTION_SOURCE_DIR;

TEST(WeatherLogs, ALogIsGivenWithItsVehicleAndItsWeather) {
  const WeatherLog log = WeatherLog::parse("ini/wads.ini=logs/wads.rawlog=snow");
  EXPECT_EQ(log.config, "ini/wads.ini");
  EXPECT_EQ(log.log, "logs/wads.rawlog");
  EXPECT_EQ(log.name(), "wads");
  EXPECT_EQ(log.type, WeatherType::kSnow);
  EXPECT_FALSE(log.isScenario());
  EXPECT_TRUE(WeatherLog::parse("a.ini=b.ini").isScenario());
  EXPECT_EQ(WeatherLog::parse("a.ini=b.ini").type, WeatherType::kClear);
  for (const char* wrong : {"a.ini", "a.ini=", "=b.rawlog", "a.ini=b.rawlog=hail", "a=b=c=d"})
    EXPECT_THROW(WeatherLog::parse(wrong), Error) << wrong;
}

TEST(WeatherLogs, TheDemoIsClearAndInDropsItRains) {
  const WeatherLog demo{kRoot + "/ini/demo.ini", kRoot + "/rawlogs/demo.rawlog",
                        WeatherType::kClear};
  const auto clear = weatherOf(demo, nullptr, 1);
  ASSERT_GT(clear.size(), 50U);
  for (const WeatherRow& row : clear) EXPECT_EQ(row.state.type(), WeatherType::kClear);
  const auto weather =
      precipitationOf(WeatherType::kRain, 25, SimulatedWeatherParams::Precipitation::kParticles);
  EXPECT_EQ(weatherOf(demo, &weather, 1).back().state.type(), WeatherType::kRain);
}

TEST(WeatherLogs, ALogWithoutALidarIsRefused) {
  const WeatherLog radar{kRoot + "/ini/skynet.ini", kRoot + "/rawlogs/radar.rawlog",
                         WeatherType::kClear};
  EXPECT_THROW(weatherOf(radar, nullptr, 1), DataError);
}

}  // namespace
}  // namespace perception
