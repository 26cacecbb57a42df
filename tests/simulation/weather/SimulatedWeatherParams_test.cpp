#include "libperception/simulation/weather/SimulatedWeatherParams.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "libperception/config/Config.h"
#include "libperception/simulation/weather/WeatherChain.h"
#include "libperception/simulation/world/Scenario.h"

namespace perception {
namespace {

TEST(SimulatedWeatherParams, EveryShippedIniIsWeatherOfItsOwn) {
  std::set<std::string> texts;
  std::size_t files = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(PERCEPTION_SOURCE_DIR "/ini/weather")) {
    Config config = Config::fromFile(file.path().string());
    const auto params = config.read<SimulatedWeatherParams>("weather", {}, true);
    config.finish();
    ++files;
    texts.insert(params.text());
    EXPECT_FALSE(params.text().empty()) << file.path();
    EXPECT_NE(makeWeather(params, Scenario(), 1), nullptr) << file.path();
  }
  EXPECT_GE(files, 14u);
  EXPECT_EQ(texts.size(), files);
}

TEST(SimulatedWeatherParams, ExhaustIsSeenInColdOrDampAir) {
  SimulatedWeatherParams p;
  EXPECT_FALSE(p.plumes());
  p.air_temperature = 5;
  EXPECT_TRUE(p.plumes());
  p.air_temperature = 20, p.humidity = 0.9;
  EXPECT_TRUE(p.plumes());
}

}  // namespace
}  // namespace perception
