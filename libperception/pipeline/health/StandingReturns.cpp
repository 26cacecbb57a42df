#include "libperception/pipeline/health/StandingReturns.h"

#include <cmath>

namespace perception {
namespace {

constexpr double kStandingCell = 1, kStandingFrom = 0.3,
                 kStandingTo = 3;  // [m]; heights above the ground; assumed

constexpr double kStandingAge = 0.5;  // [s]

}  // namespace

std::optional<std::size_t> StandingReturns::cellOf(double x, double y) {
  const double column = std::floor(x / kStandingCell) + kCells / 2,
               row = std::floor(y / kStandingCell) + kCells / 2;
  if (!(column >= 0 && column < kCells && row >= 0 && row < kCells)) return std::nullopt;
  return static_cast<std::size_t>(row) * kCells + static_cast<std::size_t>(column);
}

void StandingReturns::add(const SensorFrame& frame, const LidarCloud& cloud) {
  cells_.reset();
  stamp_ = frame.stamp;
  T_ego_world_ = frame.ego.T_world_ego.inverse();
  // The height above the ground is linear in a return's place: most returns are of the road.
  const Vector3 up(-frame.ground.a, -frame.ground.b, 1);
  const Vector3 slope = frame.T_ego_sensor.linear().transpose() * up;
  const double offset = up.dot(frame.T_ego_sensor.translation()) - frame.ground.c;
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    const Vector3 at(static_cast<double>(cloud.x[k]), static_cast<double>(cloud.y[k]),
                     static_cast<double>(cloud.z[k]));
    const double height = slope.dot(at) + offset;
    if (!(height >= kStandingFrom && height <= kStandingTo)) continue;
    const Vector3 p = frame.T_ego_sensor * at;
    if (const auto cell = cellOf(p.x(), p.y())) cells_.set(*cell);
  }
}

bool StandingReturns::at(const Vector2& place, Stamp now) const {
  if (now - stamp_ > kStandingAge) return false;
  const double z = T_ego_world_.inverse().translation().z();
  const Vector3 p = T_ego_world_ * Vector3(place.x(), place.y(), z);
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      const auto cell = cellOf(p.x() + kStandingCell * dx, p.y() + kStandingCell * dy);
      if (cell && cells_.test(*cell)) return true;
    }
  }
  return false;
}

}  // namespace perception
