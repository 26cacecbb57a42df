#include "libperception/simulation/weather/surfaces/ShopWindows.h"

#include <gtest/gtest.h>

#include "libperception/simulation/cameras/CameraBoxes.h"
#include "libperception/simulation/lidar/LidarSensor.h"
#include "libperception/simulation/weather/surfaces/Fresnel.h"
#include "libperception/simulation/world/World.h"
#include "tests/simulation/SceneText.h"

namespace perception {
namespace {

using test::kCamera, test::kRoofLidar, test::kStanding, test::parked, test::scenarioOf;

/// A house to the left whose front is at y = 6 m, from x = 0 to 10 m; glass from 0.5 to 3 m.
const std::string kHouse = parked("house", "box", 5, 10, "length = 10\nwidth = 8\nheight = 8");

/// Boxes of `scans` images of a camera at the origin that looks along x.
std::vector<ObjectDetection> mirrored(double share, const std::string& objects, int scans,
                                      const std::string& camera = kCamera) {
  const World world(scenarioOf(kStanding + camera + objects));
  const SensorParams& sensor = world.scenario().sensors.front();
  ShopWindows windows(share, 3);
  std::vector<ObjectDetection> found;
  for (int s = 0; s < scans; ++s) {
    SensorFrame frame;
    frame.T_ego_sensor = sensor.T_ego_sensor() * opticalAxes();
    ObjectDetections none;
    none.camera = sensor.cameraModel();
    frame.data = none;
    windows.advance(world, sensor, 0);
    Rng rng({9, static_cast<std::uint64_t>(s), 0, 1});
    windows.alter(sensor, frame, rng);
    const auto& boxes = std::get<ObjectDetections>(frame.data).objects;
    found.insert(found.end(), boxes.begin(), boxes.end());
  }
  return found;
}

TEST(ShopWindows, APersonBeforeAWindowIsSeenBehindIt) {
  constexpr int kImages = 4000;
  const std::string person = parked("person", "pedestrian", 15, 2);  // its image is at (15, 10)
  const auto boxes = mirrored(1, kHouse + person, kImages);
  const CameraModel camera = scenarioOf(kStanding + kCamera).sensors.front().cameraModel();
  ASSERT_FALSE(boxes.empty());
  for (const auto& box : boxes) {
    EXPECT_EQ(box.label, "Pedestrian");
    EXPECT_NEAR(.5 * (box.image_box->x1 + box.image_box->x2), camera.cx - camera.fx * 10 / 15, 15);
  }
  // The glass reflects 14 % at this angle: the detector finds half of what it would find.
  const double height = 1.65 - 1.7 / 2;
  const double reflected = glassReflectance(10 / std::hypot(15, 10, height));
  const double chance = .9 * (reflected - .05) / .2;
  EXPECT_NEAR(static_cast<double>(boxes.size()) / kImages, chance, .05);
}

TEST(ShopWindows, ABoxOverThePanoramasSeamBeginsInsideOfIt) {
  const std::string panorama = "[sensor.CAMERA]\nkind = spherical_camera\n";
  const CameraModel camera = scenarioOf(kStanding + panorama).sensors.front().cameraModel();
  const std::string behind = parked("house", "box", -10, 0, "length = 8\nwidth = 20\nheight = 8"),
                    cyclist = parked("cyclist", "cyclist", -3.5, 0);  // its image is at (-8.5, 0)
  const auto boxes = mirrored(1, behind + cyclist, 500, panorama);
  ASSERT_FALSE(boxes.empty());
  for (const auto& box : boxes) {
    EXPECT_EQ(box.label, "Pedestrian");  // the panorama's detector knows no cyclists
    EXPECT_GE(box.image_box->x1, 0);
    EXPECT_LT(box.image_box->x1, camera.width);
    EXPECT_GT(box.image_box->x2, camera.width);
  }
}

TEST(ShopWindows, WallsAndWhatNoWindowShowsHaveNoImage) {
  EXPECT_TRUE(mirrored(0, kHouse + parked("person", "pedestrian", 15, 2), 500).empty());
  EXPECT_TRUE(mirrored(1, kHouse + parked("beyond", "pedestrian", 25, 2), 500).empty());
  EXPECT_TRUE(mirrored(1, kHouse + parked("behind", "pedestrian", 15, 12), 500).empty());
  const std::string low = parked("low", "box", 5, 10, "length = 10\nwidth = 8\nheight = 3");
  EXPECT_TRUE(mirrored(1, low + parked("person", "pedestrian", 15, 2), 500).empty());
}

TEST(ShopWindows, GlassIsALittleOfAMirrorAndAllOfOneAtAGrazingAngle) {
  EXPECT_NEAR(glassReflectance(1), 2 * .0425 / 1.0425, .001);  // (.52 / 2.52)^2 a surface
  EXPECT_NEAR(glassReflectance(0), 1, 1e-9);
  EXPECT_NEAR(glassReflectance(std::cos(radians(60))), .158, .01);
}

/// A scan along a house whose front is at y = 6 m.
LidarSensor::Scan scanned(double share, const std::string& objects) {
  const std::string house = parked("house", "box", 25, 10, "length = 30\nwidth = 8\nheight = 8");
  const World world(scenarioOf(kStanding + kRoofLidar + house + objects));
  LidarCaster caster(world);
  LidarSensorParams p;
  p.azimuth_from = radians(9), p.azimuth_to = radians(30);
  p.range_noise = 0, p.loss = 0;
  ShopWindows windows(share, 3);
  const SensorParams& sensor = world.scenario().sensors.front();
  windows.advance(world, sensor, 0);
  const PulseHook hook = [&](LidarPulse& pulse, Rng& rng) { windows.alter(sensor, pulse, rng); };
  const auto at = [](double) { return makePose(0, 0, 1.73, 0); };
  return LidarSensor(p, 10).scan(caster, 0, at, {1, 0, 0, 1}, hook);
}

TEST(ShopWindows, BeamsPassThroughGlass) {
  const auto onFront = [](const LidarSensor::Scan& scan) {
    int returns = 0;
    for (std::size_t i = 0; i < scan.cloud.size(); ++i)
      returns += std::abs(scan.cloud.y[i] - 6) < .1F && std::abs(scan.cloud.z[i]) < 1.F;
    return static_cast<double>(returns);
  };
  EXPECT_NEAR(onFront(scanned(1, "")) / onFront(scanned(0, "")), .25, .05);
}

TEST(ShopWindows, ACarThatAWindowShowsAtAGrazingAngleIsBehindItToALidar) {
  const auto scan = scanned(1, parked("car", "car", 35, 3));  // its image is at y = 9
  int images = 0;
  for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
    if (scan.phantoms[i] != Phantom::kMirror) continue;
    ++images;
    EXPECT_NEAR(scan.cloud.x[i], 35, 2.6);
    EXPECT_NEAR(scan.cloud.y[i], 9, 1.2);
  }
  EXPECT_GT(images, 3);
}

}  // namespace
}  // namespace perception
