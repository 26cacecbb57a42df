#include "libperception/sensors/ego/PoseMotion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Random.h"

namespace perception {
namespace {

/// Poses of a drive at 10 m/s at 10 Hz that begins to turn left after 3 s, by 0.2 rad/s more each
/// second, with normal noise of `place` [m] and `yaw` [rad].
class NoisyDrive {
 public:
  NoisyDrive(double place, double yaw, double period = 0.1) : period_(period) {
    Rng random(RngKey{5, 0, 0, 2});
    double x = 0, y = 0, heading = 0;
    for (int k = 0; k * period < 6; ++k) {
      EgoState state;
      state.stamp = Stamp::fromSeconds(1000 + k * period);
      state.T_world_ego = makePose(x + place * random.normal(), y + place * random.normal(), 0,
                                   heading + yaw * random.normal());
      poses_.push_back(state);
      heading += period * yawRateAt(k * period);
      x += period * 10 * std::cos(heading), y += period * 10 * std::sin(heading);
    }
  }
  static double yawRateAt(double t) { return t < 3 ? 0 : 0.2 * (t - 3); }

  /// Root mean square of the errors of speed [m/s] and yaw rate [rad/s] at the poses of the times
  /// from `begin` to `end` [s], each by the poses up to it.
  std::pair<double, double> errors(double begin, double end) const {
    double speed = 0, yaw_rate = 0;
    int count = 0;
    for (int k = static_cast<int>(std::lround(begin / period_)); k * period_ < end; ++k, ++count) {
      const std::deque<EgoState> known(poses_.begin(), poses_.begin() + k + 1);
      const PoseMotion motion = motionAt(known, known.back().stamp);
      speed += std::pow(motion.velocity.norm() - 10, 2);
      yaw_rate += std::pow(motion.yaw_rate - yawRateAt(k * period_), 2);
    }
    return {std::sqrt(speed / count), std::sqrt(yaw_rate / count)};
  }

 private:
  double period_;
  std::deque<EgoState> poses_;
};

TEST(PoseMotion, NoPosesHaveNoMotion) {
  EXPECT_EQ(motionAt({}, Stamp::fromSeconds(1)).velocity.norm(), 0);
  EXPECT_EQ(motionAt({EgoState{}}, Stamp::fromSeconds(1)).yaw_rate, 0);
}

TEST(PoseMotion, SmoothPosesTellItAtOnce) {
  const auto [speed, yaw_rate] = NoisyDrive(0, 0).errors(3, 6);
  EXPECT_LT(speed, 0.05);
  EXPECT_LT(yaw_rate, 0.025) << "the mean of the last tenth of a second";
}

TEST(PoseMotion, OnAStraightRoadNoiseBecomesLittleMotion) {
  // The difference of two poses would be wrong by 0.7 m/s and 0.05 rad/s.
  const auto [speed, yaw_rate] = NoisyDrive(0.05, radians(0.2)).errors(1, 3);
  EXPECT_LT(speed, 0.35);
  EXPECT_LT(yaw_rate, 0.025);
}

TEST(PoseMotion, ATurnThatBeginsInNoisyPosesIsFollowed) {
  const auto [speed, yaw_rate] = NoisyDrive(0.05, radians(0.2)).errors(3, 6);
  EXPECT_LT(speed, 0.35);
  EXPECT_LT(yaw_rate, 0.035);
}

}  // namespace
}  // namespace perception
