#include "studies/motion/HeadingScene.h"

#include <algorithm>
#include <cmath>

namespace perception::heading_scene {
namespace {

constexpr double kDuration = 16;                 // [s]
constexpr double kView = 20, kCameraRange = 15;  // [m]
constexpr double kCameraDetection = 0.6, kRadarDetection = 0.5;

}  // namespace

std::vector<CarState> drive(Rng& rng) {
  CarState s;
  const bool oncoming = rng.uniform() < 0.5;
  s.p = oncoming ? Vector2(18, 3.5) : Vector2(11, -16);
  s.v = 5;
  s.heading = oncoming ? kPi : kPi / 2;
  const double stop = rng.uniform(1.5, 2.5);
  const bool turns = rng.uniform() < 0.5;
  std::vector<CarState> path{s};
  for (double t = kStep; t < kDuration + 1e-9; t += kStep) {
    const bool brakes = t > stop && t < stop + 4 && s.v > 0;
    const double a = brakes ? -2.5 : t >= stop + 4 && s.v < 6 ? 1.5 : 0;
    s.v = std::max(0.0, s.v + a * kStep);
    const bool in_turn = turns && t > stop + 5 && t < stop + 7.2;
    const double yaw_rate = (in_turn ? s.v / 9 : 0) + rng.normal(0, radians(2));
    s.p += kStep * s.v * Vector2(std::cos(s.heading), std::sin(s.heading));
    s.heading = wrapAngle(s.heading + yaw_rate * kStep);
    path.push_back(s);
  }
  return path;
}

std::vector<Seen> sense(const std::vector<CarState>& path, bool radar, double flip, Rng& rng) {
  std::vector<Seen> out;
  for (std::size_t k = 0; k < path.size(); ++k) {
    const CarState& s = path[k];
    const double range = s.p.norm(), bearing = std::atan2(s.p.y(), s.p.x());
    Seen seen;
    seen.in_view = range < kView && std::abs(bearing) < kPi / 2;
    if (k % 2 == 0 && seen.in_view && range < kCameraRange && rng.uniform() < kCameraDetection) {
      const bool flipped = rng.uniform() < flip;
      seen.camera =
          Vector3(bearing + rng.normal(0, kBearingSigma), range + rng.normal(0, 0.06 * range + 0.2),
                  s.heading + rng.normal(0, kAxisSigma) + (flipped ? kPi : 0));
    }
    if (radar && k % 5 == 2 && seen.in_view && rng.uniform() < kRadarDetection) {
      const Vector2 v = s.v * Vector2(std::cos(s.heading), std::sin(s.heading));
      seen.radar = Vector3(range + rng.normal(0, 0.7), bearing + rng.normal(0, radians(3)),
                           s.p.dot(v) / range + rng.normal(0, 0.3));
    }
    out.push_back(seen);
  }
  return out;
}

}  // namespace perception::heading_scene
