#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Random.h"
#include "libperception/measurement/models/FootprintModel.h"
#include "libperception/vision/VisionFrontEnd.h"

namespace perception {
namespace {

/// A closed panorama of `width` pixels.
CameraModel panorama(int width) {
  CameraModel camera;
  camera.projection = CameraModel::Projection::kEquirectangular;
  camera.width = width, camera.height = width / 2;
  camera.fx = camera.fy = width / kTwoPi;
  camera.cx = 0.5 * width, camera.cy = 0.25 * width;
  return camera;
}

/// An optical frame above the roof, looking forward and `down` [rad].
Pose3 sphericalCameraPose(double down = 0) {
  Pose3 pose = makePose(0.3, 0, 2.5, 0, down);
  Eigen::Matrix3d optical;
  optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  pose.linear() = (pose.linear() * optical).eval();
  return pose;
}

/// Image box of a cylinder of radius .3 m and height 1.7 m that stands at (x, y) in the ego frame;
/// over the seam it reaches beyond the width.
ObjectDetection::ImageBox personBox(double x, double y, const CameraModel& camera,
                                    const Pose3& T_ego_camera) {
  const Pose3 T = T_ego_camera.inverse();
  const Vector3 middle = T * Vector3(x, y, 0.85);
  const double center = std::atan2(middle.x(), middle.z());
  double left = 10, right = -10, top = 10, bottom = -10;
  for (int i = 0; i < 720; ++i) {
    const double a = radians(0.5 * i);
    for (const double z : {0.0, 1.7}) {
      const Vector3 p = T * Vector3(x + 0.3 * std::cos(a), y + 0.3 * std::sin(a), z);
      const double off = wrapAngle(std::atan2(p.x(), p.z()) - center);
      const double phi = std::atan2(p.y(), std::hypot(p.x(), p.z()));
      left = std::min(left, off), right = std::max(right, off);
      top = std::min(top, phi), bottom = std::max(bottom, phi);
    }
  }
  const double u = center * camera.fx + camera.cx;
  return {u + left * camera.fx, top * camera.fy + camera.cy, u + right * camera.fx,
          bottom * camera.fy + camera.cy};
}

std::unique_ptr<FrontEnd> front_end(const std::string& keys = "") {
  Config config = Config::fromText(
      "[class.car]\nmotion = wheeled\n[class.pedestrian]\nmotion = constant-velocity\n"
      "[sensor.PANO]\nkind = boxes\nmodality = C\nfov_deg = 360\n[sensor.PANO.detector]\n" +
          keys,
      "pano.ini");
  const ClassTable classes = readClassTable(config);
  auto front_end = makeVisionFrontEnd(config, "PANO", classes);
  config.finish();
  return front_end;
}

SensorFrame frameOf(std::vector<ObjectDetection> objects, const CameraModel& camera) {
  SensorFrame frame;
  frame.sensor = "PANO";
  frame.T_ego_sensor = sphericalCameraPose();
  frame.data = ObjectDetections{camera, std::move(objects), std::nullopt};
  return frame;
}

ObjectDetection detection(const std::string& label, const ObjectDetection::ImageBox& box,
                          double score = 1) {
  ObjectDetection d;
  d.label = label, d.score = score, d.image_box = box;
  return d;
}

TEST(SphericalCamera, RecoversBearingsAndRangeAllAround) {
  // method.md 4.2 as bars: the chain itself costs less than 1 % of the range to 30 m.
  Rng rng({6, 0, 0, 0});
  const CameraModel camera = panorama(8192);
  const Pose3 pose = sphericalCameraPose();
  for (int trial = 0; trial < 300; ++trial) {
    const double bearing = rng.uniform(-kPi, kPi), range = rng.uniform(3, 30);
    const double x = 0.3 + range * std::cos(bearing), y = range * std::sin(bearing);
    const auto out = boxOnGround(personBox(x, y, camera, pose), camera, pose, {}, {}, {});
    ASSERT_TRUE(out && out->range) << bearing << " " << range;
    EXPECT_TRUE(out->left_seen && out->right_seen);
    EXPECT_NEAR(wrapAngle(middleBearing(out->left, out->right) - bearing), 0, 1e-6);
    EXPECT_NEAR(wrapAngle(out->left - out->right), 2 * std::asin(0.3 / range), 1e-3);
    EXPECT_NEAR(*out->range, range - 0.3, 0.002 * range);
    EXPECT_NEAR(out->height, 1.7, 0.15);
  }
}

TEST(SphericalCamera, AnInclinedCameraGivesTheSame) {
  const CameraModel camera = panorama(8192);
  const Pose3 pose = sphericalCameraPose(radians(8));
  for (const double bearing : {-3.1, -2.0, -0.7, 0.0, 0.9, 1.6, 3.0}) {
    const double x = 0.3 + 12 * std::cos(bearing), y = 12 * std::sin(bearing);
    const auto out = boxOnGround(personBox(x, y, camera, pose), camera, pose, {}, {}, {});
    ASSERT_TRUE(out && out->range);
    EXPECT_NEAR(*out->range, 11.7, 0.15);
    EXPECT_NEAR(wrapAngle(middleBearing(out->left, out->right) - bearing), 0, radians(0.5));
  }
}

TEST(SphericalCamera, PitchIsInTheRange) {
  BoxGeometryParams p;
  p.bottom_sigma = 0.1;
  p.bottom_share = p.range_floor = 0;
  p.pitch_sigma = radians(1);
  PoseUncertainty sure;
  sure.sigma_pitch = 0;
  const CameraModel camera = panorama(2048);
  const Pose3 pose = sphericalCameraPose();
  const auto sigma = [&](double range) {
    return boxOnGround(personBox(0.3, range + 0.3, camera, pose), camera, pose, {}, sure, p)
        ->range_sigma;
  };
  EXPECT_NEAR(sigma(8), 0.49,
              0.02);  // method.md 4.2: a degree is .5 m at 8 m, 1.6 at 15, 6.3 at 30
  EXPECT_NEAR(sigma(15), 1.61, 0.04);
  EXPECT_NEAR(sigma(30), 6.33, 0.1);
}

TEST(SphericalCamera, AnObjectOnTheSeamIsOneMeasurement) {
  const CameraModel camera = panorama(2048);
  const auto whole = personBox(-8, -0.02, camera, sphericalCameraPose());  // behind the vehicle
  ASSERT_GT(whole.x2, camera.width);
  const auto joined = front_end()->extract(frameOf({detection("person", whole)}, camera));
  ASSERT_EQ(joined.measurements.size(), 1u);
  // The same from a detector that works on the flat picture and cuts at its borders.
  auto left = whole, right = whole;
  left.x2 = camera.width - 1;
  right.x1 = 0, right.x2 -= camera.width;
  right.y1 += 2;
  const auto halves = front_end()->extract(
      frameOf({detection("person", right, 0.9), detection("car", {900, 500, 1100, 700}),
               detection("person", left, 0.8)},
              camera));
  ASSERT_EQ(halves.measurements.size(), 2u);
  const Measurement &one = joined.measurements[0], &two = halves.measurements[1];
  EXPECT_EQ(two.detection, 2);
  for (int axis = 0; axis < FootprintModel::kAxes; ++axis)
    EXPECT_NEAR(one.z[axis], two.z[axis], 1e-9);
  EXPECT_NEAR((one.position - Vector2(-7.7, -0.02)).norm(), 0, 0.15);
}

TEST(SphericalCamera, TwoObjectsAtTheSeamStayTwo) {
  const CameraModel camera = panorama(2048);
  std::vector<ObjectDetection> objects = {detection("person", {2010, 520, 2040, 620}),
                                          detection("person", {2, 520, 30, 620})};
  EXPECT_EQ(joinSeam(camera, 4, objects).size(), 2u);  // one does not reach the seam
  objects = {detection("person", {2010, 520, 2047, 620}), detection("car", {0, 520, 30, 620})};
  EXPECT_EQ(joinSeam(camera, 4, objects).size(), 2u);  // another label
  objects = {detection("person", {2010, 520, 2047, 560}), detection("person", {0, 590, 30, 720})};
  EXPECT_EQ(joinSeam(camera, 4, objects).size(), 2u);  // other rows
  CameraModel flat = camera;
  flat.projection = CameraModel::Projection::kPinhole;
  objects = {detection("person", {2010, 520, 2047, 620}), detection("person", {0, 520, 30, 620})};
  EXPECT_EQ(joinSeam(flat, 4, objects).size(), 2u);
}

TEST(SphericalCamera, ObservationAngleBecomesTheHeadingInTheWorld) {
  const CameraModel camera = panorama(4096);
  Rng rng({7, 0, 0, 0});
  for (int trial = 0; trial < 100; ++trial) {
    const double bearing = rng.uniform(-kPi, kPi), heading = rng.uniform(-kPi, kPi);
    const double ego_yaw = rng.uniform(-kPi, kPi);
    auto d = detection("Car", personBox(0.3 + 9 * std::cos(bearing), 9 * std::sin(bearing), camera,
                                        sphericalCameraPose()));
    // KITTI: rotation_y = -heading - 90 deg in the camera's frame, alpha = rotation_y - azimuth
    // (clockwise).
    d.heading = wrapAngle(-heading - kPi / 2 + bearing);
    SensorFrame frame = frameOf({d}, camera);
    frame.ego.T_world_ego = makePose(50, -20, 0, ego_yaw);
    const auto scan = front_end("heading_sigma_deg = 10\nheading_flip = 0.3\n")->extract(frame);
    ASSERT_EQ(scan.measurements.size(), 1u);
    ASSERT_TRUE(scan.measurements[0].heading);
    const MeasuredHeading& seen = *scan.measurements[0].heading;
    EXPECT_NEAR(wrapAngle(seen.yaw - heading - ego_yaw), 0, 1e-6);
    EXPECT_NEAR(seen.sigma, std::hypot(radians(10), radians(0.2)), 1e-9);
    EXPECT_EQ(seen.flip_probability, 0.3);
  }
  const auto without =
      front_end()->extract(frameOf({detection("Car", {900, 500, 1100, 700})}, camera));
  EXPECT_FALSE(without.measurements.at(0).heading);
}

}  // namespace
}  // namespace perception
