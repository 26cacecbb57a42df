#include "libperception/simulation/weather/WeatherChain.h"

#include <gtest/gtest.h>

#include <sstream>
#include "libperception/core/Error.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/simulation/Simulator.h"
#include "tests/simulation/SceneText.h"

namespace perception {
namespace {

using test::kCamera, test::kRoofLidar, test::kStanding, test::parked, test::scenarioOf;

const std::string kRadar = "[sensor.RADAR]\nkind = radar\nz = 0.5\n";
const std::string kWeatherScene =
    kStanding + kRoofLidar + "azimuth_step_deg = 1\nrate = 4\n" + kCamera + kRadar +
    parked("car", "car", 14, 0) + parked("far", "van", 45, 3) +
    "[object.moving]\nkind = car\nt = -5, 5\nx = -80, 120\ny = 4, 4\n";

/// All numbers that a run's sensors gave, in their order.
std::vector<float> played(const std::string& weather, std::uint64_t seed = 3, int threads = 1) {
  Simulator simulator(scenarioOf(kWeatherScene + weather), "street", seed, threads);
  std::vector<float> all;
  while (const auto o = simulator.next()) {
    const auto frame = frameFromObservation(*o);
    if (!frame) continue;
    if (const auto* cloud = std::get_if<LidarCloud>(&frame->data)) {
      for (std::size_t i = 0; i < cloud->size(); ++i)
        all.insert(all.end(), {cloud->x[i], cloud->y[i], cloud->z[i], cloud->intensity[i]});
    } else if (const auto* boxes = std::get_if<ObjectDetections>(&frame->data)) {
      for (const auto& d : boxes->objects) all.push_back(static_cast<float>(d.image_box->x1));
    } else if (const auto* radar = std::get_if<RadarReturns>(&frame->data)) {
      for (const auto& r : radar->returns) all.push_back(static_cast<float>(r.range));
    }
  }
  return all;
}

const std::string kEverything = R"([weather]
rain_mm_h = 20
snow_mm_h = 2
fog_mor = 200
water_film_mm = 1
sky = sunny
fouling = .05
snow_cover = .1
air_temperature = 0
)";

TEST(WeatherChain, NothingSetIsClearAir) {
  EXPECT_EQ(makeWeather({}, {}, 1), nullptr);
  EXPECT_EQ(played("[weather]\n"), played(""));
  EXPECT_TRUE(SimulatedWeatherParams().text().empty());
}

TEST(WeatherChain, SameSeedSameScansWhateverTheThreads) {
  const auto one = played(kEverything);
  EXPECT_EQ(one, played(kEverything, 3, 3));
  EXPECT_NE(one, played(kEverything, 4));
  EXPECT_NE(one, played(""));
}

TEST(WeatherChain, PhenomenaAddUp) {
  SimulatedWeatherParams p;
  p.rain_mm_h = 10, p.fog_mor = 100;
  const auto weather = makeWeather(p, {}, 1);
  ASSERT_NE(weather, nullptr);
  EXPECT_TRUE(weather->actsOnPulses());
  Rng rng({1, 0, 0, 0});
  Lighting light;
  light.haze = 0;
  weather->alter(SensorParams(), light, rng);
  EXPECT_NEAR(light.haze, 0.0016 + 0.03, 1e-4);
}

TEST(WeatherChain, TheFirstCommentSaysTheWeather) {
  Simulator simulator(scenarioOf(kWeatherScene + kEverything), "street", 3);
  const auto first = simulator.next();
  std::ostringstream text;
  first->getDescriptionAsText(text);
  EXPECT_NE(text.str().find("weather: rain 20 mm/h, snow 2 mm/h, fog 200 m, water film 1 mm, snow "
                            "cover 0.1, sunny, "),
            std::string::npos)
      << text.str();
}

TEST(WeatherChain, UnknownKeysAreConfigurationErrors) {
  EXPECT_THROW(scenarioOf(kWeatherScene + "[weather]\nhail = 1\n"), ConfigError);
  EXPECT_THROW(scenarioOf(kWeatherScene + "[weather]\nfog_mor = 3\n"), ConfigError);
}

}  // namespace
}  // namespace perception
