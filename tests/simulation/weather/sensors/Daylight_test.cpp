#include "libperception/simulation/weather/sensors/Daylight.h"

#include <gtest/gtest.h>

#include "tests/simulation/weather/WeatherBeams.h"

namespace perception {
namespace {

using Sky = SimulatedWeatherParams::Sky;
using test::kCamera, test::kStanding, test::parked, test::scenarioOf;

// An oncoming car, a parked car beside it, a pedestrian to the left.
const std::string kStreet = kStanding + kCamera +
                            "[object.oncoming]\nkind = car\nt = 0, 10\nx = 30, 10\ny = 2, 2\n" +
                            parked("beside", "car", 30, 0) + parked("left", "pedestrian", 0, 20) +
                            parked("near", "pedestrian", 0, -10);

std::vector<double> chances(Sky sky, double sun_elevation_deg) {
  const World world(scenarioOf(kStreet));
  Lighting light;
  light.sun_azimuth = 0, light.sun_elevation = radians(sun_elevation_deg);
  Daylight daylight(sky, light);
  const SensorParams& camera = world.scenario().sensors.front();
  daylight.advance(world, camera, 0);
  std::vector<double> all;
  for (std::size_t i = 0; i < world.objects(); ++i) {
    const Vector3 place = world.object(i, 0).T_world_object.translation();
    CameraLook look;
    look.object = i, look.range = place.head<2>().norm(), look.chance = 1;
    look.azimuth = std::atan2(place.y(), place.x());
    Rng rng({1, 0, 0, 0});
    daylight.alter(camera, look, rng);
    all.push_back(look.chance);
  }
  return all;
}

TEST(Daylight, NightHidesWhatHeadlightsDoNotReachAndDazzles) {
  EXPECT_EQ(chances(Sky::kNight, 40), (std::vector<double>{0.5, 0.35, 0.5, 1}));
}

TEST(Daylight, LowSunDazzlesInItsDirection) {
  EXPECT_EQ(chances(Sky::kSunny, 10), (std::vector<double>{0.7, 0.7, 1, 1}));
  EXPECT_EQ(chances(Sky::kSunny, 40), (std::vector<double>{1, 1, 1, 1}));
  EXPECT_EQ(chances(Sky::kCloudy, 10), (std::vector<double>{1, 1, 1, 1}));
}

TEST(Daylight, SunRaisesTheLidarsThresholdAndAddsNoise) {
  Daylight sunny(Sky::kSunny, {});
  int noise = 0, beams = 0;
  test::scanSky(sunny, 100, [&](int, int, const LidarPulse& pulse) {
    ++beams, noise += static_cast<int>(pulse.scatterers.size());
    EXPECT_EQ(pulse.threshold, 1.5);
  });
  EXPECT_NEAR(noise / (2e-5 * beams), 1, 0.5);  // 23 expected
  EXPECT_FALSE(Daylight(Sky::kNight, {}).actsOnPulses());
}

TEST(Daylight, ImagesAreDarkAtNightAndWithoutShadowsUnderClouds) {
  Rng rng({1, 0, 0, 0});
  Lighting night, clouds, sun;
  Daylight(Sky::kNight, night).alter(SensorParams(), night, rng);
  Daylight(Sky::kCloudy, clouds).alter(SensorParams(), clouds, rng);
  Daylight(Sky::kSunny, sun).alter(SensorParams(), sun, rng);
  EXPECT_FALSE(night.hasSun());
  EXPECT_LT(night.ambient, 0.05);
  EXPECT_FALSE(clouds.hasSun());
  EXPECT_GT(clouds.ambient, 0.3);
  EXPECT_EQ(sun.sun_elevation, Lighting().sun_elevation);
}

}  // namespace
}  // namespace perception
