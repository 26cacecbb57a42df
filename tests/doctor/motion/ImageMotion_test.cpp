#include "libperception/doctor/motion/ImageMotion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <random>

#include "libperception/doctor/motion/MotionCheck.h"
#include "tests/doctor/TestDrive.h"

namespace perception {
namespace {

using test::kDuration;
using test::poseAt;
using test::posesOf;
using test::stampAt;

/// A camera of 77 deg in a world of gray balls of .15 m beside and above the way.
class World {
 public:
  explicit World(const std::vector<EgoState>& poses) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> away(-25, 25), high(0, 8), gray(0, 255);
    for (std::size_t i = 0; i < poses.size(); ++i)
      for (int k = 0; k < 12; ++k)
        balls_.push_back(
            {poses[i].T_world_ego * Vector3(30, away(random), high(random)), gray(random)});
  }
  static CameraModel camera() { return {640, 400, 400, 400, 319.5, 199.5}; }
  Raster seenFrom(const Pose3& T_world_camera) const {
    const CameraModel c = camera();
    struct Disk {
      double z, u, v, gray;
    };
    std::vector<Disk> disks;
    const Pose3 T_camera_world = T_world_camera.inverse();
    for (const Ball& ball : balls_) {
      const Vector3 p = T_camera_world * ball.place;
      if (p.z() < 4 || p.z() > 60) continue;
      disks.push_back({p.z(), c.fx * p.x() / p.z() + c.cx, c.fy * p.y() / p.z() + c.cy, ball.gray});
    }
    std::sort(disks.begin(), disks.end(), [](const Disk& a, const Disk& b) { return a.z > b.z; });
    cv::Mat image(c.height, c.width, CV_8UC1, cv::Scalar(128));
    constexpr int kShift = 6;  // bits behind the point
    const auto fixed = [](double x) { return static_cast<int>(std::lround(x * (1 << kShift))); };
    for (const Disk& d : disks) {
      if (std::abs(d.u) > 2000 || std::abs(d.v) > 2000) continue;
      cv::circle(image, {fixed(d.u), fixed(d.v)}, fixed(0.15 * c.fx / d.z), cv::Scalar(d.gray),
                 cv::FILLED, cv::LINE_AA, kShift);
    }
    Raster out{c.width, c.height, 1, {}};
    out.pixels.assign(image.data, image.data + image.total());
    return out;
  }

 private:
  struct Ball {
    Vector3 place;
    double gray;
  };
  std::vector<Ball> balls_;
};

/// An optical frame in a vehicle's, looking ahead.
Pose3 cameraAt(double yaw, double pitch) {
  Pose3 ahead = Pose3::Identity();
  ahead.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return makePose(1.5, 0.1, 1.6, yaw, pitch, 0) * ahead;
}

/// Where the camera of all tests is.
Pose3 rightMounting() { return cameraAt(radians(2), radians(1)); }

/// Of a drive with images at 10 Hz, stamped `late`.
std::vector<CameraMotion> motions(double late) {
  static const std::vector<CameraMotion> all = [] {
    const auto poses = posesOf({});
    const World world(poses);
    ImageMotion motion;
    std::vector<CameraMotion> out;
    for (double t = 0; t < kDuration - 0.5; t += 0.1)
      if (const auto m = motion.update(
              World::camera(), world.seenFrom(poseAt(poses, t) * rightMounting()), stampAt(t)))
        out.push_back(*m);
    return out;
  }();
  std::vector<CameraMotion> out = all;
  const auto by = static_cast<std::int64_t>(std::llround(late * 1e9));
  for (CameraMotion& m : out) m.from.ns += by, m.to.ns += by;
  return out;
}

TEST(ImageMotion, IsThatOfTheCamera) {
  const auto poses = posesOf({});
  const auto seen = motions(0);
  ASSERT_GT(seen.size(), 80U);
  std::vector<double> turns, ways;
  for (const CameraMotion& m : seen) {
    const auto at = [&](Stamp s) { return poseAt(poses, s - stampAt(0)) * rightMounting(); };
    const Pose3 truth = at(m.from).inverse() * at(m.to);
    turns.push_back(Eigen::AngleAxisd(m.turn.transpose() * truth.linear()).angle());
    ways.push_back(std::acos(std::min(1.0, m.travel.dot(truth.translation().normalized()))));
  }
  std::sort(turns.begin(), turns.end());
  std::sort(ways.begin(), ways.end());
  EXPECT_LT(degrees(turns[turns.size() / 2]), 0.2);
  EXPECT_LT(degrees(ways[ways.size() / 2]), 1);
}

TEST(ImageMotion, CameraTurnedAndLateIsFound) {
  const Pose3 logged = cameraAt(radians(7), radians(-4));
  const auto check = checkImageMotion(motions(0.08), logged, posesOf({}));
  ASSERT_TRUE(check);
  EXPECT_NEAR(check->clock.error, 0.08, 0.02);
  EXPECT_NEAR(degrees(check->yaw.error), 5, 1);
  EXPECT_NEAR(degrees(check->pitch.error), -5, 1);
  EXPECT_TRUE(check->clock.isWrong() && check->yaw.isWrong() && check->pitch.isWrong());
  EXPECT_FALSE(check->ahead.observable() || check->left.observable());
}

TEST(ImageMotion, RightCameraIsNotWrong) {
  const auto check = checkImageMotion(motions(0), rightMounting(), posesOf({}));
  ASSERT_TRUE(check);
  EXPECT_TRUE(check->clock.observable());
  EXPECT_FALSE(check->clock.isWrong() || check->yaw.isWrong() || check->pitch.isWrong() ||
               check->roll.isWrong());
}

TEST(ImageMotion, StandingCameraShowsNone) {
  const auto poses = posesOf({});
  const World world(poses);
  ImageMotion motion;
  const Raster image = world.seenFrom(poseAt(poses, 5) * cameraAt(0, 0));
  for (int i = 0; i < 8; ++i) EXPECT_FALSE(motion.update(World::camera(), image, stampAt(0.1 * i)));
}

TEST(ImageMotion, BlankImagesShowNone) {
  ImageMotion motion;
  const Raster image{640, 400, 1, std::vector<std::uint8_t>(640 * 400, 90)};
  for (int i = 0; i < 8; ++i) EXPECT_FALSE(motion.update(World::camera(), image, stampAt(0.1 * i)));
}

}  // namespace
}  // namespace perception
