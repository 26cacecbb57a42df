#include "libperception/odometry/RadarOdometry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

/// Targets of a radar: `standing` posts, `moving` cars of 25 m/s straight ahead over ground.
struct Street {
  int standing = 40, moving = 10;
  double noise = 0.05;  ///< [m/s]
};

SensorFrame radarAt(const Pose3& T_ego_sensor, const Vector3& motion, double t,
                    const Street& street, Rng& rng) {
  RadarReturns radar;
  const Vector3 p = T_ego_sensor.translation();
  for (int i = 0; i < street.standing + street.moving; ++i) {
    RadarReturn r;
    r.bearing = rng.uniform(-0.3, 0.3);
    r.range = rng.uniform(5, 100);
    const Vector3 u = T_ego_sensor.linear() * Vector3(std::cos(r.bearing), std::sin(r.bearing), 0);
    const Vector3 own(motion.x() - motion.z() * p.y(), motion.y() + motion.z() * p.x(), 0);
    const Vector3 target = i < street.standing ? Vector3::Zero() : Vector3(25, 0, 0);
    r.range_rate = u.dot(target - own) + rng.normal(0, street.noise);
    radar.returns.push_back(r);
  }
  SensorFrame frame;
  frame.stamp = Stamp{1'000'000'000'000 + static_cast<std::int64_t>(t * 1e9)};
  frame.T_ego_sensor = T_ego_sensor;
  frame.data = std::move(radar);
  return frame;
}

const Pose3 kFront = makePose(3.8, 0, 0.5, 0), kRear = makePose(-1.1, 0, 0.5, kPi);

/// Drives with that motion for four seconds at 15 Hz; simulated.
RadarMotion after(const Vector3& motion, const Street& street, bool both, RadarOdometry& odometry) {
  Rng rng({2, 0, 0, 0});
  for (int k = 0; k < 60; ++k) {
    const SensorFrame front = radarAt(kFront, motion, k / 15.0, street, rng),
                      rear = radarAt(kRear, motion, k / 15.0, street, rng);
    odometry.update(both ? std::vector<const SensorFrame*>{&front, &rear}
                         : std::vector<const SensorFrame*>{&front});
  }
  return odometry.motion();
}

TEST(RadarOdometry, FindsSpeedAndYawRateAmongTraffic) {
  for (const double speed : {0.0, 3.0, 30.0, -2.0}) {
    for (const bool both : {true, false}) {
      RadarOdometry odometry;
      const RadarMotion found = after({speed, 0, 0.1 * (speed > 1)}, {}, both, odometry);
      EXPECT_NEAR(found.mean.x(), speed, 0.1) << both;
      EXPECT_NEAR(found.mean.z(), speed > 1 ? 0.1 : 0, 0.02) << both;
      EXPECT_EQ(odometry.lost(), 0U);
    }
  }
}

TEST(RadarOdometry, ErrorsAreAsLargeAsStated) {
  double squares = 0;
  int n = 0;
  RadarOdometry odometry;
  Rng rng({3, 0, 0, 0});
  const Street noisy{30, 6, 0.15};
  for (int k = 0; k < 300; ++k) {
    const double speed = 15 + 5 * std::sin(0.1 * k);
    const SensorFrame front = radarAt(kFront, {speed, 0, 0.05}, k / 15.0, noisy, rng);
    odometry.update({&front});
    if (k < 15) continue;
    const double error = odometry.motion().mean.x() - speed;
    squares += error * error / odometry.motion().covariance(0, 0), ++n;
  }
  EXPECT_LT(squares / n, 2.0);
  EXPECT_GT(squares / n, 0.3);
}

TEST(RadarOdometry, ThePoseIsDeadReckoning) {
  RadarOdometry odometry;
  Rng rng({4, 0, 0, 0});
  std::optional<EgoState> last;
  for (int k = 0; k <= 150; ++k) {  // 10 s on a circle of 50 m
    const SensorFrame front = radarAt(kFront, {10, 0, 0.2}, k / 15.0, {}, rng),
                      rear = radarAt(kRear, {10, 0, 0.2}, k / 15.0, {}, rng);
    last = odometry.update({&front, &rear});
  }
  ASSERT_TRUE(last);
  const Vector2 end(50 * std::sin(2.0), 50 * (1 - std::cos(2.0)));
  EXPECT_LT((last->T_world_ego.translation().head<2>() - end).norm(), 1.5);
  EXPECT_NEAR(yawOf(last->T_world_ego), 2, 0.03);
}

TEST(RadarOdometry, FollowsWhatStandsWhenItBeganWithATrafficJam) {
  RadarOdometry odometry;
  Rng rng({5, 0, 0, 0});
  const Vector3 motion(20, 0, 0);
  for (int k = 0; k < 30; ++k) {
    const Street street{k < 5 ? 5 : 40, k < 5 ? 40 : 5, 0.05};
    const SensorFrame front = radarAt(kFront, motion, k / 15.0, street, rng);
    odometry.update({&front});
    if (k == 4) {
      EXPECT_LT(odometry.motion().mean.x(), 0) << "the cars are taken for standing";
    }
  }
  EXPECT_NEAR(odometry.motion().mean.x(), 20, 0.1);
}

TEST(RadarOdometry, WithoutTargetsThereIsNoMotion) {
  RadarOdometry odometry;
  Rng rng({6, 0, 0, 0});
  const SensorFrame empty = radarAt(kFront, {10, 0, 0}, 0, {0, 0, 0}, rng);
  EXPECT_FALSE(odometry.update({&empty}));
  const SensorFrame full = radarAt(kFront, {10, 0, 0}, 1, {}, rng);
  EXPECT_TRUE(odometry.update({&full}));
  EXPECT_FALSE(odometry.update({&full})) << "the same instant again";
}

}  // namespace
}  // namespace perception
