#include "libperception/doctor/motion/MotionCheck.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/doctor/TestDrive.h"

namespace perception {
namespace {

using test::Drive;
using test::kDuration;
using test::poseAt;
using test::posesOf;
using test::stampAt;

const Pose3 kRight = makePose(1.2, 0.3, 1.7, radians(4), radians(1), 0);

/// Poses by odometry from a lidar at kRight that the log has at `logged`, `late` by its clock.
/// Noise of a step: 1 cm, .03 deg.
std::vector<EgoState> odometryOf(const std::vector<EgoState>& poses, const Pose3& logged,
                                 double late) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise;
  const Pose3 X = logged * kRight.inverse();
  std::vector<EgoState> scans;
  Pose3 T = Pose3::Identity();
  for (double t = 0; t + 0.1 < kDuration - 0.5; t += 0.1) {
    EgoState state;
    state.stamp = stampAt(t + late);
    state.T_world_ego = T;
    scans.push_back(state);
    T = T * X * poseAt(poses, t).inverse() * poseAt(poses, t + 0.1) * X.inverse() *
        makePose(0.01 * noise(random), 0.01 * noise(random), 0.01 * noise(random),
                 radians(0.03) * noise(random), radians(0.03) * noise(random),
                 radians(0.03) * noise(random));
  }
  return scans;
}

Pose3 wrongBy(double ahead, double left, double yaw, double pitch, double roll) {
  Pose3 out = kRight;
  out.linear() = makePose(0, 0, 0, yaw, pitch, roll).linear() * out.linear();
  out.translation() += Vector3(ahead, left, 0);
  return out;
}

TEST(MotionCheck, RightMountingAndClockOfALidarAreNotWrong) {
  const auto poses = posesOf({});
  const auto check = checkLidarMotion(odometryOf(poses, kRight, 0), kRight, poses);
  ASSERT_TRUE(check);
  for (const auto& v :
       {check->yaw, check->pitch, check->roll, check->ahead, check->left, check->clock}) {
    EXPECT_TRUE(v.observable());
    EXPECT_FALSE(v.isWrong());
    EXPECT_LT(std::abs(v.error), 4 * v.sigma);
  }
  EXPECT_TRUE(correctedMounting(*check, kRight).isApprox(kRight));
}

TEST(MotionCheck, LidarTurnedShiftedAndLateIsFound) {
  const auto poses = posesOf({});
  for (const double sign : {-1.0, 1.0}) {
    const Pose3 logged =
        wrongBy(sign * 0.2, -sign * 0.2, sign * radians(5), radians(-5), radians(5));
    const auto check = checkLidarMotion(odometryOf(poses, logged, sign * 0.08), logged, poses);
    ASSERT_TRUE(check);
    EXPECT_NEAR(degrees(check->yaw.error), sign * 5, 1);
    EXPECT_NEAR(degrees(check->pitch.error), -5, 1);
    EXPECT_NEAR(degrees(check->roll.error), 5, 1);
    EXPECT_NEAR(check->ahead.error, sign * 0.2, 0.1);
    EXPECT_NEAR(check->left.error, -sign * 0.2, 0.1);
    EXPECT_NEAR(check->clock.error, sign * 0.08, 0.02);
    EXPECT_TRUE(check->yaw.isWrong() && check->clock.isWrong() && check->left.isWrong());
    EXPECT_TRUE(correctedMounting(*check, logged).isApprox(kRight, 0.03));
  }
}

TEST(MotionCheck, StraightDriveShowsNeitherPlaceNorRoll) {
  const auto poses = posesOf({3, 0});
  const auto check = checkLidarMotion(odometryOf(poses, kRight, 0.08), kRight, poses);
  ASSERT_TRUE(check);
  EXPECT_FALSE(check->roll.observable() || check->ahead.observable() || check->left.observable());
  EXPECT_TRUE(check->yaw.observable() && check->pitch.observable());
  EXPECT_NEAR(check->clock.error, 0.08, 0.02);  // braking shows it
}

TEST(MotionCheck, PosesThatClimbWithoutPitchShowNoPitch) {
  auto poses = posesOf({});
  const auto scans = odometryOf(poses, kRight, 0);
  for (auto& pose : poses) {
    const double seconds = pose.stamp - stampAt(0);
    pose.T_world_ego.translation().z() = 0.2 * seconds;  // a slope of about 2 %
  }
  const auto check = checkLidarMotion(scans, kRight, poses);
  ASSERT_TRUE(check);
  EXPECT_FALSE(check->pitch.observable());
  EXPECT_TRUE(check->yaw.observable() && check->clock.observable());
}

TEST(MotionCheck, SteadyStraightDriveShowsNoClock) {
  const auto poses = posesOf({0, 0});
  const auto check = checkLidarMotion(odometryOf(poses, kRight, 0.08), kRight, poses);
  ASSERT_TRUE(check);
  EXPECT_FALSE(check->clock.observable());
  EXPECT_FALSE(check->clock.isWrong());
}

TEST(MotionCheck, StandingVehicleShowsNothing) {
  std::vector<EgoState> poses = posesOf({});
  for (auto& pose : poses) pose.T_world_ego = Pose3::Identity();
  EXPECT_FALSE(checkLidarMotion(odometryOf(poses, kRight, 0), kRight, poses));
}

/// Returns of standing things in front of a radar at `mounting`, a fifth of them on a moving
/// vehicle; noise .1 m/s.
RadarReturns radarAt(const std::vector<EgoState>& poses, const Pose3& mounting, double t,
                     std::mt19937& random) {
  std::normal_distribution<double> noise;
  std::uniform_real_distribution<double> bearing(radians(-45), radians(45));
  const Pose3 a = poseAt(poses, t - 0.01) * mounting, b = poseAt(poses, t + 0.01) * mounting;
  const Vector3 v = mounting.linear().transpose() * poseAt(poses, t).linear().transpose() *
                    (b.translation() - a.translation()) / 0.02;
  RadarReturns radar;
  for (int i = 0; i < 20; ++i) {
    RadarReturn r;
    r.range = 10 + i, r.bearing = bearing(random);
    r.range_rate = -rotate2(r.bearing, Vector2(1, 0)).dot(v.head<2>()) + 0.1 * noise(random);
    if (i % 5 == 0) r.range_rate += 4;
    radar.returns.push_back(r);
  }
  return radar;
}

TEST(MotionCheck, RadarTurnedAndLateIsFound) {
  const auto poses = posesOf({});
  const Pose3 right = makePose(3.5, 0.5, 0.5, radians(20));
  const Pose3 logged = makePose(3.5, 0.5, 0.5, radians(25));
  std::mt19937 random(3);
  std::vector<SensorVelocity> seen;
  for (double t = 0; t < kDuration - 0.5; t += 0.06)
    if (const auto v = radarVelocity(radarAt(poses, right, t, random), stampAt(t + 0.08)))
      seen.push_back(*v);
  EXPECT_GT(seen.size(), 450U);
  const auto check = checkRadarMotion(seen, logged, poses);
  ASSERT_TRUE(check);
  EXPECT_NEAR(degrees(check->yaw.error), 5, 1);
  EXPECT_NEAR(check->clock.error, 0.08, 0.02);
  EXPECT_TRUE(check->yaw.isWrong() && check->clock.isWrong());
  EXPECT_FALSE(check->pitch.observable() || check->roll.observable());
  EXPECT_NEAR(degrees(yawOf(correctedMounting(*check, logged))), 20, 1);
}

/// Fixes at 10 Hz, .03 m, in a world turned by 2 rad, of an antenna .5 m ahead and .2 m to the
/// right.
std::vector<AntennaPlace> fixesOf(const std::vector<EgoState>& poses, double late) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.03);
  std::vector<AntennaPlace> fixes;
  for (double t = 0; t < kDuration - 0.5; t += 0.1) {
    const Vector3 place = poseAt(poses, t) * Vector3(0.5, -0.2, 0);
    fixes.push_back({stampAt(t + late),
                     rotate2(2, Vector2(place.head<2>())) + Vector2(noise(random), noise(random))});
  }
  return fixes;
}

TEST(MotionCheck, GnssThatIsLateAndItsAntennaAreFound) {
  const auto poses = posesOf({});
  for (const double late : {0.0, 0.08, -0.25}) {
    const auto check = checkGnssMotion(fixesOf(poses, late), Vector2(0.5, 0.3), poses);
    ASSERT_TRUE(check);
    EXPECT_TRUE(check->clock.observable()) << check->clock.sigma;
    EXPECT_NEAR(check->clock.error, late, 0.02);
    EXPECT_EQ(check->clock.isWrong(), late != 0);
    EXPECT_NEAR(check->left.error, 0.5, 0.1);
    EXPECT_FALSE(check->yaw.observable());
  }
}

TEST(MotionCheck, GnssOnASteadyStraightDriveShowsNoClock) {
  const auto poses = posesOf({0, 0});
  const auto check = checkGnssMotion(fixesOf(poses, 0.08), Vector2(0.5, -0.2), poses);
  ASSERT_TRUE(check);
  EXPECT_FALSE(check->clock.observable());
}

}  // namespace
}  // namespace perception
