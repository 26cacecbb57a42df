#include "libperception/simulation/recorded/RecordedImage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "libperception/simulation/cameras/CameraBoxes.h"

#include "libperception/simulation/recorded/RecordedScene.h"
#include "libperception/simulation/weather/WeatherChain.h"
#include "libperception/simulation/weather/particles/Fog.h"
#include "libperception/simulation/world/Scenario.h"
#include "libperception/simulation/world/World.h"

namespace perception {
namespace {

constexpr int kImageWidth = 300, kImageHeight = 100;
constexpr std::uint8_t kDark = 60, kLight = 180;

/// Dark and light stripes, four pixels each.
Raster stripes() {
  Raster image{kImageWidth, kImageHeight, 3, {}};
  for (int i = 0; i < kImageWidth * kImageHeight; ++i)
    image.pixels.insert(image.pixels.end(), 3, i % kImageWidth / 4 % 2 ? kLight : kDark);
  return image;
}

/// A camera before a wall that fills its image.
struct RecordedShot {
  World world;
  LidarCaster caster;
  SensorParams sensor;

  RecordedShot() : world(recordedScene({}, {}, 1)), caster(world, 1) {
    sensor.kind = SensorKind::kCameraImages, sensor.label = "CAMERA";
  }

  Raster in(const SimulatedWeatherParams& conditions, double wall, std::uint64_t seed = 1,
            const Raster& image = stripes()) {
    std::unique_ptr<SimulatedWeather> weather = makeWeather(conditions, world.scenario(), seed);
    if (!weather) weather = std::make_unique<SimulatedWeather>();
    weather->advance(world, sensor, 0);
    CameraView view;
    view.camera.width = kImageWidth, view.camera.height = kImageHeight;
    view.camera.fx = view.camera.fy = 1000, view.camera.cx = 149.5, view.camera.cy = 49.5;
    view.T_world_camera = makePose(0, 0, 8, 0) * opticalAxes();
    std::vector<Vector3> returns;
    for (double y = -.2; y <= .2; y += .002)
      for (double z = -.1; z <= .1; z += .002) returns.push_back({wall, wall * y, 8 + wall * z});
    return throughWeather(image, view, returns, *weather, sensor, caster, {seed, 0, 0, 0});
  }
};

/// Difference in radiance of a light stripe and the dark one beside it, middle of the image.
double difference(const Raster& image) {
  const Lighting light;
  const auto radiance = [&](std::size_t u) {
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t v = 40; v < 60; ++v)
        sum +=
            light.radianceOf(Rgb::Constant(linearOf(image.pixels[3 * (v * kImageWidth + u + k)])))
                .x();
    return sum / 80;
  };
  return radiance(148) - radiance(144);
}

TEST(RecordedImage, ClearAirLeavesEveryByte) {
  EXPECT_EQ(RecordedShot().in({}, 30).pixels, stripes().pixels);
}

TEST(RecordedImage, FogTakesContrastByKoschmieder) {
  SimulatedWeatherParams fog;
  fog.fog_mor = 60;
  const double clear = difference(stripes());
  EXPECT_NEAR(difference(RecordedShot().in(fog, 15)) / clear, std::pow(.05, .25), 0.02);
  EXPECT_NEAR(difference(RecordedShot().in(fog, 30)) / clear, std::sqrt(.05), 0.02);
  EXPECT_NEAR(difference(RecordedShot().in(fog, 60)) / clear, .05,
              0.015);  // the end of sight; of bytes
}

TEST(RecordedImage, AtNightFarWallsAreDarkerByTheSquareOfTheRange) {
  SimulatedWeatherParams night;
  night.sky = SimulatedWeatherParams::Sky::kNight;
  const auto mean = [](const Raster& image) {
    const Lighting light;
    double sum = 0;
    for (std::size_t u = 145; u < 155; ++u)
      for (std::size_t v = 70; v < 100; ++v)  // below the cut-off
        sum +=
            light.radianceOf(Rgb::Constant(linearOf(image.pixels[3 * (v * kImageWidth + u)]))).x();
    return sum;
  };
  const Raster bright{kImageWidth, kImageHeight, 3,
                      std::vector<std::uint8_t>(3 * kImageWidth * kImageHeight, 200)};
  const double near = mean(RecordedShot().in(night, 8, 1, bright)),
               far = mean(RecordedShot().in(night, 16, 1, bright));
  const double ambient = 1e-4, lamps = 0.2;
  EXPECT_NEAR(near / far, (ambient + lamps / 64) / (ambient + lamps / 256), 0.2);
}

TEST(RecordedImage, TheSameSeedGivesTheSameBytes) {
  SimulatedWeatherParams snow;
  snow.snow_mm_h = 2.5;
  const Raster first = RecordedShot().in(snow, 30);
  EXPECT_EQ(first.pixels, RecordedShot().in(snow, 30).pixels);
  EXPECT_NE(first.pixels, RecordedShot().in(snow, 30, 2).pixels);
}

TEST(RecordedImage, GrayImagesStayGray) {
  SimulatedWeatherParams fog;
  fog.fog_mor = 60;
  const Raster gray{kImageWidth, kImageHeight, 1,
                    std::vector<std::uint8_t>(kImageWidth * kImageHeight, 90)};
  const Raster after = RecordedShot().in(fog, 30, 1, gray);
  EXPECT_EQ(after.channels, 1);
  EXPECT_EQ(after.pixels.size(), gray.pixels.size());
}

}  // namespace
}  // namespace perception
