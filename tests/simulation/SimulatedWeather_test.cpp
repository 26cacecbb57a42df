#include "libperception/simulation/SimulatedWeather.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/simulation/Simulator.h"
#include "libperception/simulation/lidar/LidarSensor.h"
#include "libperception/simulation/world/World.h"
#include "tests/simulation/SceneText.h"

namespace perception {
namespace {

using test::kCamera, test::kRoofLidar, test::kStanding, test::parked, test::scenarioOf;

const std::string kScene = kStanding + kRoofLidar +
                           "azimuth_from_deg = -20\nazimuth_to_deg = 20\nazimuth_step_deg = 0.5\n" +
                           kCamera + parked("car", "car", 12, 0);

/// What all frames of a label came to.
struct Sums {
  std::size_t points = 0, boxes = 0;
  double nearest = 1e9;
};
Sums play(Simulator& simulator) {
  Sums sums;
  while (const auto o = simulator.next()) {
    const auto frame = frameFromObservation(*o);
    if (!frame) continue;
    if (const auto* cloud = std::get_if<LidarCloud>(&frame->data)) {
      sums.points += cloud->size();
      for (const float x : cloud->x) sums.nearest = std::min<double>(sums.nearest, x);
    } else if (const auto* boxes = std::get_if<ObjectDetections>(&frame->data)) {
      sums.boxes += boxes->objects.size();
    }
  }
  return sums;
}

Sums playIn(std::unique_ptr<SimulatedWeather> weather, int threads = 1) {
  Simulator simulator(scenarioOf(kScene), "street", 3, threads);
  if (weather) simulator.setWeather(std::move(weather));
  return play(simulator);
}

/// Clear air that is asked about every pulse.
class Asked : public SimulatedWeather {
 public:
  bool actsOnPulses() const override { return true; }
};

TEST(SimulatedWeather, ClearAirChangesNothing) {
  const Sums without = playIn(nullptr), clear = playIn(std::make_unique<SimulatedWeather>()),
             asked = playIn(std::make_unique<Asked>());
  EXPECT_GT(without.points, 10000u);
  EXPECT_EQ(without.points, clear.points);
  EXPECT_EQ(without.points, asked.points);
  EXPECT_EQ(without.boxes, clear.boxes);
}

/// Something thick before every beam, and a detector that is blind.
class Wall final : public Asked {
 public:
  void alter(const SensorParams&, LidarPulse& pulse, Rng& rng) const override {
    pulse.scatterers.push_back({rng.uniform(2, 3), 1});
    pulse.optical_depth = 5;
  }
  void alter(const SensorParams&, CameraLook& look, Rng&) const override { look.chance = 0; }
  using SimulatedWeather::alter;
};

TEST(SimulatedWeather, StrongerScattererReplacesTheSurface) {
  const Sums fog = playIn(std::make_unique<Wall>());
  EXPECT_GT(fog.points, playIn(nullptr).points) << "beams to the sky return, too";
  EXPECT_LT(fog.nearest, 3.1);
  EXPECT_LT(fog.boxes, playIn(nullptr).boxes) << "false boxes alone are left";
  const Sums many = playIn(std::make_unique<Wall>(), 3);
  EXPECT_EQ(fog.points, many.points);
  EXPECT_EQ(fog.nearest, many.nearest);
}

/// Fog at night.
class Night final : public SimulatedWeather {
 public:
  void alter(const SensorParams&, Lighting& light, Rng&) const override {
    light.sun_elevation = radians(-10), light.ambient = 0.01, light.haze = 0.05;
  }
  using SimulatedWeather::alter;
};

double meanBrightness(std::unique_ptr<SimulatedWeather> weather) {
  Simulator simulator(scenarioOf(kStanding +
                                 "[sensor.CAMERA]\nkind = camera_images\n"
                                 "width = 128\nrate = 1\n" +
                                 parked("car", "car", 12, 0)),
                      "street", 3);
  if (weather) simulator.setWeather(std::move(weather));
  double sum = 0, count = 0;
  while (const auto o = simulator.next()) {
    if (!isImage(*o)) continue;
    const auto raster = std::get<CameraImage>(frameFromObservation(*o)->data).load();
    if (!raster) return -1;
    for (const std::uint8_t value : raster->pixels) sum += value, ++count;
  }
  EXPECT_EQ(count, 2 * 128 * 64 * 3);
  return sum / count;
}

TEST(SimulatedWeather, ChangesTheLightOfImages) {
  EXPECT_GT(meanBrightness(nullptr), 90);
  EXPECT_LT(meanBrightness(std::make_unique<Night>()), 40);
}

/// All images of a street in the weather, one after the other.
std::vector<std::uint8_t> imagesIn(const std::string& weather, std::uint64_t seed, int threads) {
  Simulator simulator(scenarioOf(kStanding + weather +
                                 "[sensor.CAMERA]\nkind = camera_images\n"
                                 "width = 128\nheight = 64\nfov_deg = 80\nz = 1.5\nrate = 1\n" +
                                 parked("car", "car", 12, 0)),
                      "street", seed, threads);
  std::vector<std::uint8_t> bytes;
  while (const auto o = simulator.next()) {
    if (!isImage(*o)) continue;
    const auto raster = std::get<CameraImage>(frameFromObservation(*o)->data).load();
    bytes.insert(bytes.end(), raster->pixels.begin(), raster->pixels.end());
  }
  return bytes;
}

TEST(SimulatedWeather, FlakesInImagesAreAFunctionOfTheSeed) {
  const std::string snow = "[weather]\nsnow_mm_h = 10\n";
  EXPECT_EQ(imagesIn(snow, 3, 1), imagesIn(snow, 3, 4));
  EXPECT_NE(imagesIn(snow, 3, 1), imagesIn(snow, 4, 1));
  EXPECT_EQ(imagesIn("", 3, 1), imagesIn("", 4, 1));
}

TEST(SimulatedWeather, AtNightTheOwnHeadlightsLightTheRoadAhead) {
  const auto night = imagesIn("[weather]\nsky = night\n", 3, 1);
  const auto rows = [&](std::size_t from, std::size_t to) {  // mean of the first image
    double sum = 0;
    for (std::size_t i = 3 * 128 * from; i < 3 * 128 * to; ++i) sum += night.at(i);
    return sum / static_cast<double>(3 * 128 * (to - from));
  };
  EXPECT_GT(rows(60, 64), rows(36, 40) + 10);  // road 4 m ahead, and 20 m
}

TEST(BeamWidth, EdgesReturnPartsAndMixedPixels) {
  // A board 0.3 m before a wall: rays see one or the other, wide beams also something between.
  const World world(scenarioOf(
      kStanding + kCamera + parked("wall", "box", 20, 0, "length = 1\nwidth = 20\nheight = 6") +
      parked("board", "box", 19.2, 0, "length = .5\nwidth = 1\nheight = 6")));
  const auto between = [&](double divergence) {
    LidarCaster caster(world);
    LidarSensorParams p;
    p.azimuth_from = radians(-10), p.azimuth_to = radians(10);
    p.range_noise = 0, p.loss = 0, p.divergence = divergence;
    const LidarSensor lidar(p, 10);
    const auto at = [](double) { return makePose(0, 0, 1.73, 0); };
    const auto scan = lidar.scan(caster, 0, at, {1, 0, 0, 1});
    std::size_t mixed = 0;  // the wall's face is x = 19.5, the board's 18.95
    for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
      mixed += scan.cloud.x[i] > 19.05f && scan.cloud.x[i] < 19.4f && scan.cloud.z[i] > -1.5f;
    }
    return mixed;
  };
  EXPECT_EQ(between(0), 0u);
  EXPECT_GT(between(radians(0.17)), 5u);
}

}  // namespace
}  // namespace perception
