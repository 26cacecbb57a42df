#include "libperception/simulation/cameras/ImageCamera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "libperception/core/Error.h"
#include "libperception/simulation/cameras/CameraView.h"
#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/world/Appearance.h"
#include "libperception/simulation/world/World.h"
#include "tests/simulation/SceneText.h"

namespace perception {
namespace {

using test::kCamera, test::kStanding, test::parked, test::scenarioOf;

constexpr double kEye = 1.7;  // [m]
const Pose3 kImageLens = makePose(0, 0, kEye, 0) * opticalAxes();

ImageCameraParams panorama() { return {}; }
ImageCameraParams pinhole() {
  ImageCameraParams p;
  p.width = 640, p.height = 360, p.fov = radians(80);
  return p;
}

/// Sun to the right of the vehicle, behind it.
Lighting clearDay() {
  Lighting light;
  light.sun_azimuth = radians(-100), light.sun_elevation = radians(35);
  return light;
}

struct Shot {
  World world;
  LidarCaster caster;
  CameraModel camera;
  RenderedImage image;

  explicit Shot(const std::string& scene, const ImageCameraParams& params = panorama(),
                const Lighting& light = clearDay(), int threads = 1)
      : world(scenarioOf(kStanding + kCamera + scene)),
        caster(world, threads),
        camera(params.model()),
        image(renderImage(caster, 0, camera, light, kImageLens)) {}

  /// Red, green, blue of the pixel where a point of the world [m] is seen.
  std::array<int, 3> colorAt(const Vector3& point) const {
    const std::size_t i = indexOf(point);
    const auto& bgr = image.raster.pixels;
    return {bgr.at(3 * i + 2), bgr.at(3 * i + 1), bgr.at(3 * i)};
  }
  int brightnessAt(const Vector3& point) const {
    const auto c = colorAt(point);
    return c[0] + c[1] + c[2];
  }
  int objectAt(const Vector3& point) const { return image.objects.at(indexOf(point)); }

 private:
  std::size_t indexOf(const Vector3& point) const {
    const Vector3 p = kImageLens.inverse() * point;
    double x = p.x() / p.z(), y = p.y() / p.z();
    if (camera.projection == CameraModel::Projection::kEquirectangular) {
      x = std::atan2(p.x(), p.z()), y = std::atan2(p.y(), std::hypot(p.x(), p.z()));
    }
    const auto u = static_cast<std::size_t>(std::lround(camera.cx + camera.fx * x)),
               v = static_cast<std::size_t>(std::lround(camera.cy + camera.fy * y));
    return v * static_cast<std::size_t>(camera.width) + u;
  }
};

/// The name of a car whose paint is what the test asks for.
std::string carNamed(const std::function<bool(const Rgb&)>& wanted) {
  ObjectParams car;
  for (int i = 0; i < 1000; ++i) {
    car.name = "car" + std::to_string(i);
    if (wanted(bodyColor(car))) return car.name;
  }
  return "";
}

bool isBlue(const Rgb& c) { return c.z() > 2 * c.x() && c.z() > 1.5 * c.y(); }
bool isRed(const Rgb& c) { return c.x() > 4 * c.z(); }

TEST(ImageCamera, CarIsWhereItsPlaceProjectsInItsColor) {
  for (const ImageCameraParams& params : {panorama(), pinhole()}) {
    const Shot blue(parked(carNamed(isBlue), "car", 9, 2), params);
    const Shot red(parked(carNamed(isRed), "car", 9, 2), params);
    const Vector3 side(8.9, 1.1, .6);  // of the body, towards the camera and the sun
    EXPECT_EQ(blue.objectAt(side), 0);
    EXPECT_GT(blue.colorAt(side)[2], blue.colorAt(side)[0] + 40);
    EXPECT_GT(red.colorAt(side)[0], red.colorAt(side)[2] + 40);
    EXPECT_EQ(blue.objectAt({9, -2, 0}), BeamHit::kRoad);
    EXPECT_EQ(blue.objectAt({9, 2, 4}), BeamHit::kNothing);
    const auto sky = blue.colorAt({9, 2, 5});
    EXPECT_GT(sky[2], sky[0]) << "the sky is blue";
  }
}

TEST(ImageCamera, WhatStandsBeforeHidesWhatStandsBehind) {
  const Shot shot(parked("near", "pedestrian", 6, 0) + parked("far", "car", 12, 0));
  EXPECT_EQ(shot.objectAt({5.8, 0, 1.2}), 0);
  EXPECT_EQ(shot.objectAt({11, .7, .7}), 1);
  // Listed the other way round it looks the same.
  const Shot other(parked("far", "car", 12, 0) + parked("near", "pedestrian", 6, 0));
  EXPECT_EQ(shot.image.raster.pixels, other.image.raster.pixels);
}

TEST(ImageCamera, ShadowLiesOnTheSideAwayFromTheSun) {
  const std::string wall =
      parked("wall", "box", 8, 0, "length = 4\nwidth = 0.3\nheight = 1.2");  // along x
  const Vector3 left(8, .9, 0), right(8, -.9, 0);  // the shadow is 1.7 m long
  Lighting light = clearDay();
  light.sun_azimuth = radians(-90);
  const Shot sun_right(wall, panorama(), light);
  EXPECT_LT(sun_right.brightnessAt(left), .7 * sun_right.brightnessAt(right));
  light.sun_azimuth = radians(90);
  const Shot sun_left(wall, panorama(), light);
  EXPECT_LT(sun_left.brightnessAt(right), .7 * sun_left.brightnessAt(left));
  light.sun_elevation = radians(-5);  // no shadows, less light
  const Shot dusk(wall, panorama(), light);
  EXPECT_NEAR(dusk.brightnessAt(left), dusk.brightnessAt(right), 40);
  EXPECT_LT(dusk.brightnessAt(left), .7 * sun_left.brightnessAt(left));
}

TEST(ImageCamera, HazeFadesWhatIsFarIntoTheHorizon) {
  const std::string scene = parked("far", "box", 90, -4, "height = 9\nwidth = 8\nlength = 1");
  Lighting clear = clearDay(), fog = clearDay();
  clear.haze = 0, fog.haze = 0.03;
  const Shot a(scene, panorama(), clear), b(scene, panorama(), fog);
  const Vector3 horizon(1000, 300, 20), road(3, 1, 0), far(89.4, -4, 6);
  const int sky = b.brightnessAt(horizon);
  EXPECT_NEAR(b.brightnessAt(far), sky, 25);
  EXPECT_GT(std::abs(a.brightnessAt(far) - sky), 60);
  EXPECT_LT(std::abs(b.brightnessAt(road) - a.brightnessAt(road)), 60);
}

TEST(ImageCamera, LightOfTheScenarioSetsBrightness) {
  Lighting dark = clearDay();
  dark.exposure /= 4;
  const Vector3 road(6, -1, 0);
  EXPECT_LT(Shot("", panorama(), dark).brightnessAt(road), .7 * Shot("").brightnessAt(road));
  const Scenario s = scenarioOf(kStanding + kCamera +
                                "[light]\nsun_elevation_deg = -10\nambient = 0.01\nexposure = 9\n"
                                "haze = 0.02\nsun_azimuth_deg = 20\n");
  EXPECT_FALSE(s.light.hasSun());
  EXPECT_EQ(s.light.haze, .02);
}

TEST(ImageCamera, RoadsAreMarkedWhereTheyDoNotCross) {
  const Shot shot(
      "[road.a]\nx = -50, 50\ny = -2, -2\nwidth = 7\n[road.b]\nx = 20, 20\ny = -50, 50\n");
  const Vector3 asphalt(5, -.5, 0), edge(5, -2 + 3.5 - .28, 0), grass(5, 8, 0),
      crossing(20, 1.22, 0);
  EXPECT_GT(shot.brightnessAt(edge), shot.brightnessAt(asphalt) + 100);
  EXPECT_LT(shot.brightnessAt(crossing), shot.brightnessAt(edge) - 100);
  EXPECT_GT(shot.colorAt(grass)[1], shot.colorAt(grass)[2] + 30) << "green";
}

/// The rectangle about an object's pixels; they must not lie on the seam.
ObjectDetection::ImageBox maskBox(const RenderedImage& image, int object) {
  ObjectDetection::ImageBox box{1e9, 1e9, -1e9, -1e9};
  for (std::size_t i = 0; i < image.objects.size(); ++i) {
    if (image.objects[i] != object) continue;
    const auto width = static_cast<std::size_t>(image.raster.width);
    const auto x = static_cast<double>(i % width), y = static_cast<double>(i / width);
    box = {std::min(box.x1, x - .5), std::min(box.y1, y - .5), std::max(box.x2, x + .5),
           std::max(box.y2, y + .5)};
  }
  return box;
}

double overlap(const ObjectDetection::ImageBox& a, const ObjectDetection::ImageBox& b) {
  const double w = std::min(a.x2, b.x2) - std::max(a.x1, b.x1),
               h = std::min(a.y2, b.y2) - std::max(a.y1, b.y1);
  const double both = std::max(0.0, w) * std::max(0.0, h);
  return both / ((a.x2 - a.x1) * (a.y2 - a.y1) + (b.x2 - b.x1) * (b.y2 - b.y1) - both);
}

TEST(ImageCamera, BoxesOfTheDetectorLieOnWhatIsRendered) {
  const std::string scene = parked("car", "car", 9, 3, "heading_deg = 30") +
                            parked("man", "pedestrian", 7, -2) + parked("bus", "bus", 20, -8);
  for (const ImageCameraParams& params : {panorama(), pinhole()}) {
    const Shot shot(scene, params);
    for (int i = 0; i < 3; ++i) {
      const auto outline =
          imageOutline(shot.world, static_cast<std::size_t>(i), 0, shot.camera, kImageLens);
      ASSERT_TRUE(outline);
      EXPECT_GT(overlap(outline->box, maskBox(shot.image, i)), .8) << i;
    }
  }
}

TEST(ImageCamera, SameBytesForAnyNumberOfThreads) {
  const std::string scene = parked("car", "car", 9, 3) + parked("man", "pedestrian", 6, -2) +
                            parked("tree", "bush", 8, -4, "base = 2") +
                            parked("wall", "box", 30, 0);
  const Shot one(scene, pinhole(), clearDay(), 1), four(scene, pinhole(), clearDay(), 4);
  EXPECT_EQ(one.image.raster.pixels, four.image.raster.pixels);
  EXPECT_EQ(one.image.objects, four.image.objects);
}

TEST(ImageCamera, TheViewIsTheImageBeforeItsBytes) {
  const Shot shot(parked("wall", "box", 10, 0, "length = .5\nwidth = 8\nheight = 3"), pinhole());
  CameraView view;
  const RenderedImage image =
      renderImage(shot.caster, 0, shot.camera, clearDay(), kImageLens, &view);
  EXPECT_EQ(image.raster.pixels, shot.image.raster.pixels);
  const Raster again = rasterOf(view);
  int off = 0;
  for (std::size_t i = 0; i < again.pixels.size(); ++i)
    off = std::max(off, std::abs(again.pixels[i] - image.raster.pixels[i]));
  EXPECT_LE(off, 1);  // rounded to floats
  const auto middle = static_cast<std::size_t>(shot.camera.width) * 180 + 320;
  EXPECT_NEAR(view.range.at(middle), 9.75, 0.05);
  EXPECT_EQ(view.range.front(), CameraView::kSky);
}

TEST(ImageCamera, FieldOfViewTellsPanoramaFromPinhole) {
  const auto camera = [](const std::string& keys) {
    return scenarioOf(kStanding + "[sensor.C]\nkind = camera_images\n" + keys)
        .sensors.at(0)
        .cameraModel();
  };
  const CameraModel whole = camera("width = 2048\n");
  EXPECT_EQ(whole.projection, CameraModel::Projection::kEquirectangular);
  EXPECT_EQ(whole.height, 1024);
  const CameraModel narrow = camera("width = 640\nheight = 480\nfov_deg = 90\n");
  EXPECT_EQ(narrow.projection, CameraModel::Projection::kPinhole);
  EXPECT_NEAR(narrow.fx, 320, 1e-9);
  EXPECT_THROW(camera("fov_deg = 200\n"), ConfigError);
}

}  // namespace
}  // namespace perception
