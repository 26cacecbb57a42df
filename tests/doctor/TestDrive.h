#pragma once
#include <cmath>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception::test {

inline constexpr double kDuration = 30;  // [s]

inline Stamp stampAt(double t) { return Stamp{1'000'000'000'000 + std::llround(t * 1e9)}; }

/// What of a drive shows the errors.
struct Drive {
  double speed_change = 3;  ///< [m/s] about 10 m/s, in a few seconds
  double turn = 0.2;        ///< [rad/s] largest yaw rate
};

/// Poses every 20 ms of a vehicle that rolls without slip.
inline std::vector<EgoState> posesOf(const Drive& drive) {
  std::vector<EgoState> poses;
  double x = 0, y = 0, yaw = 0;
  for (int i = -50; i * 0.01 < kDuration; ++i) {
    const double t = i * 0.01, speed = 10 + drive.speed_change * std::sin(0.9 * t);
    if (i % 2 == 0) {
      EgoState state;
      state.stamp = stampAt(t);
      state.T_world_ego = makePose(x, y, 0, yaw);
      poses.push_back(state);
    }
    x += 0.01 * speed * std::cos(yaw), y += 0.01 * speed * std::sin(yaw);
    yaw += 0.01 * drive.turn * std::sin(0.5 * t);
  }
  return poses;
}

inline Pose3 poseAt(const std::vector<EgoState>& poses, double t) {
  const double i = (t + 0.5) / 0.02;
  const auto k = static_cast<std::size_t>(i);
  const Pose3 step = poses[k].T_world_ego.inverse() * poses[k + 1].T_world_ego;
  const double share = i - static_cast<double>(k);
  return poses[k].T_world_ego * makePose(share * step.translation().x(),
                                         share * step.translation().y(), 0, share * yawOf(step));
}

}  // namespace perception::test
