#include "libperception/simulation/cameras/SphericalCamera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/world/World.h"
#include "tests/simulation/SceneText.h"

namespace perception {
namespace {

using test::kCamera, test::kStanding, test::parked, test::scenarioOf;

constexpr double kPanoramaEye = 2.5;  // [m]
const Pose3 kPanoramaLens = makePose(0, 0, kPanoramaEye, 0) * opticalAxes();

/// A detector without faults of its own; 4k: cars to 32 m, persons to 20 m.
SphericalCameraParams perfectPanorama() {
  SphericalCameraParams p;
  p.setResolution(SphericalCameraParams::Resolution::k4k);
  p.car_recall = p.person_recall = p.bus_recall = p.cyclist_recall = 1;
  p.false_per_image = p.edge_noise = 0;
  p.heading_bins = 0, p.heading_noise = 0, p.heading_flip = 0;
  return p;
}

ObjectDetections detect(const std::string& scene, const SphericalCameraParams& p,
                        std::uint64_t image = 0) {
  const World world(scenarioOf(kStanding + kCamera + scene));
  const LidarCaster caster(world);
  return detectPanorama(caster, 0, p, kPanoramaLens, {1, image, 0, 1});
}

TEST(SphericalCamera, ColumnsAreAzimuthsAndRowsElevations) {
  const auto d = detect(parked("man", "pedestrian", 0, 12), perfectPanorama());  // to the left
  ASSERT_EQ(d.objects.size(), 1u);
  const auto& box = *d.objects[0].image_box;
  const CameraModel& m = d.camera;
  EXPECT_EQ(m.projection, CameraModel::Projection::kEquirectangular);
  EXPECT_NEAR(.5 * (box.x1 + box.x2), .25 * m.width, 1);  // 90 deg to the left
  EXPECT_NEAR((box.y2 - m.cy) / m.fy, std::atan2(kPanoramaEye, 12), radians(0.3));
  EXPECT_NEAR((box.y1 - m.cy) / m.fy, std::atan2(kPanoramaEye - 1.7, 12), radians(0.1));
}

TEST(SphericalCamera, ObjectOnTheSeamIsOneBoxBeyondTheWidth) {
  const auto d = detect(parked("car", "car", -12, 0.2, "heading_deg = 90"), perfectPanorama());
  ASSERT_EQ(d.objects.size(), 1u);
  const auto& box = *d.objects[0].image_box;
  EXPECT_LT(box.x1, d.camera.width);
  EXPECT_GT(box.x2, d.camera.width);
  EXPECT_NEAR((box.x2 - box.x1) / d.camera.fx, 2 * std::atan2(2.25, 12 - .9), radians(0.6));
}

TEST(SphericalCamera, HeadingIsTheObservationAngle) {
  const auto d = detect(parked("car", "car", -5, 12, "heading_deg = 30"), perfectPanorama());
  ASSERT_EQ(d.objects.size(), 1u);
  ASSERT_TRUE(d.objects[0].heading);
  // alpha = rotation_y - atan2(x, z) with rotation_y = -yaw - 90 deg; x = -12, z = -5.
  EXPECT_NEAR(wrapAngle(*d.objects[0].heading - (-radians(30) - kPi / 2 - std::atan2(-12, -5))), 0,
              1e-6);
}

TEST(SphericalCamera, HeadingErrorIsEightDegreesAndSomeAreReversed) {
  SphericalCameraParams p;
  p.car_recall = 1, p.false_per_image = 0;
  constexpr int kImages = 800;
  int flipped = 0, n = 0;
  double sum = 0;
  // The bins' own error is uniform only over many aspects: turn the car.
  for (int yaw = 0; yaw < 20; ++yaw) {
    const World world(
        scenarioOf(kStanding + kCamera +
                   parked("car", "car", 10, 2, "heading_deg = " + std::to_string(yaw * 7.3))));
    const LidarCaster caster(world);
    const double truth = -radians(yaw * 7.3) - kPi / 2 - std::atan2(-2, 10);
    for (std::uint64_t i = 0; i < kImages / 20; ++i) {
      for (const auto& o : detectPanorama(caster, 0, p, kPanoramaLens, {2, i, 0, 1}).objects) {
        if (!o.heading) continue;
        double error = wrapAngle(*o.heading - truth);
        if (std::abs(error) > kPi / 2) ++flipped, error = wrapAngle(error + kPi);
        sum += error * error, ++n;
      }
    }
  }
  ASSERT_GT(n, 700);
  EXPECT_NEAR(degrees(std::sqrt(sum / n)), 8, 0.8);  // 4 sigma of an rms of 780
  EXPECT_NEAR(flipped, .2 * n, 4 * std::sqrt(.2 * .8 * n));
}

TEST(SphericalCamera, RecallAndRangeAreThePapers) {
  constexpr int kImages = 600;
  using R = SphericalCameraParams::Resolution;
  for (const auto& [resolution, car, person] :
       {std::tuple(R::k1k, 7.0, 5.0), std::tuple(R::k2k, 15.0, 10.0),
        std::tuple(R::k4k, 32.0, 20.0), std::tuple(R::k8k, 70.0, 40.0)}) {
    SphericalCameraParams p;
    p.setResolution(resolution);
    p.false_per_image = 0;
    // One of each just inside and just outside of the range (10 % of it is the fall-off).
    const World world(scenarioOf(kStanding + kCamera + parked("car", "car", .85 * car, 0) +
                                 parked("far_car", "car", -1.15 * car, 0) +
                                 parked("man", "pedestrian", 0, .85 * person) +
                                 parked("far_man", "pedestrian", 0, -1.15 * person)));
    const LidarCaster caster(world);
    int cars = 0, men = 0, others = 0;
    for (std::uint64_t i = 0; i < kImages; ++i) {
      const auto d = detectPanorama(caster, 0, p, kPanoramaLens, {3, i, 0, 1});
      for (const auto& o : d.objects) {
        const double u = std::fmod(.5 * (o.image_box->x1 + o.image_box->x2), d.camera.width);
        if (std::abs(u - d.camera.cx) < .1 * d.camera.width) {
          ++cars;
        } else if (std::abs(u - .25 * d.camera.width) < .1 * d.camera.width) {
          ++men;
        } else {
          ++others;
        }
      }
    }
    EXPECT_EQ(others, 0);
    EXPECT_NEAR(cars, .85 * kImages, 4 * std::sqrt(.85 * .15 * kImages));
    EXPECT_NEAR(men, .70 * kImages, 4 * std::sqrt(.70 * .30 * kImages));
  }
}

TEST(SphericalCamera, OneKeySetsTheResolution) {
  const Scenario s = scenarioOf(kStanding +
                                "[sensor.PANO]\nkind = spherical_camera\nresolution = 8k\n"
                                "false_per_image = 35\n");
  const SphericalCameraParams& p = s.sensors.at(0).panorama;
  EXPECT_EQ(p.width, 8000);
  EXPECT_EQ(p.car_range, 70);
  EXPECT_EQ(p.false_per_image, 35) << "a key of the file wins";
}

TEST(SphericalCamera, FalseBoxesHaveTheirRate) {
  SphericalCameraParams p = perfectPanorama();
  p.false_per_image = .5;
  const World world(scenarioOf(kStanding + kCamera + parked("pole", "pole", 8, 1)));
  const LidarCaster caster(world);
  constexpr int kImages = 1000;
  int n = 0;
  for (std::uint64_t i = 0; i < kImages; ++i) {
    const auto d = detectPanorama(caster, 0, p, kPanoramaLens, {4, i, 0, 1});
    for (const auto& o : d.objects) {
      ++n;
      EXPECT_GT(o.image_box->x2, o.image_box->x1);
      EXPECT_GE(o.image_box->x1, 0);
      EXPECT_LT(o.image_box->x1, d.camera.width);
    }
  }
  EXPECT_NEAR(n, .5 * kImages, 4 * std::sqrt(.5 * kImages));
}

}  // namespace
}  // namespace perception
