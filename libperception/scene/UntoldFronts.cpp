#include "libperception/scene/UntoldFronts.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/LogMath.h"

namespace perception {
namespace {

/// Cosine of the angle between axes that count as parallel (assumed).
constexpr double kParallel = 0.95;

/// [m] across and along the axis: who is nearer stands in the same row. Of the standing vehicles in
/// 17 KITTI sequences 173 of 207 face as their neighbor in the row does.
constexpr double kRowWidth = 1.5, kRowLength = 25;
constexpr double kShareOfRow = 0.84;

/// [m] from the own vehicle, along and across its heading, within which vehicles are taken to stand
/// along its road; `kOwnLane`: to the center of its own lane's far side. Of 184 standing vehicles
/// in KITTI and Argoverse 2 134 face as their side of the road has it.
constexpr double kRoadLength = 40, kRoadWidth = 10, kOwnLane = 2;
constexpr double kShareOfSide = 0.73;

/// What others do makes no front known.
constexpr double kMostByOthers = 0.85;

bool hasFront(const SceneObject& o, const ClassTable& classes) {
  return o.has_yaw && classes[o.class_id].motion->has_heading;
}

/// Place relative to an axis: x along it and y to the left of it [m].
Vector2 alongAxis(const Vector2& way, double yaw) {
  const double c = std::cos(yaw), s = std::sin(yaw);
  return {c * way.x() + s * way.y(), c * way.y() - s * way.x()};
}

/// Log-odds that yaw is the front of an object in a row with others whose front is known; 0: no
/// such row.
double rowLogOdds(const SceneObject& object, const ClassTable& classes,
                  const std::vector<SceneObject>& objects) {
  double nearest = kRowLength, log_odds = 0;
  for (const SceneObject& other : objects) {
    if (&other == &object || !hasFront(other, classes) || other.p_front < kSureFront) continue;
    const double along = std::cos(other.yaw - object.yaw);
    const Vector2 way = alongAxis((other.position - object.position).head<2>(), object.yaw);
    if (std::abs(along) < kParallel || std::abs(way.y()) > kRowWidth || std::abs(way.x()) > nearest)
      continue;
    nearest = std::abs(way.x());
    log_odds = along > 0 ? logit(kShareOfRow) : -logit(kShareOfRow);
  }
  return log_odds;
}

/// The same by the side of the own vehicle's road on which it stands.
double sideLogOdds(const SceneObject& object, const EgoState& ego, TrafficSide traffic) {
  if (traffic == TrafficSide::kUnknown) return 0;
  const double yaw = yawOf(ego.T_world_ego);
  const Vector2 origin = ego.T_world_ego.translation().head<2>();
  const double along = std::cos(object.yaw - yaw);
  const Vector2 way = alongAxis(object.position.head<2>() - origin, yaw);
  if (std::abs(along) < kParallel || std::abs(way.x()) > kRoadLength ||
      std::abs(way.y()) > kRoadWidth)
    return 0;
  const bool own_side = (traffic == TrafficSide::kRight ? way.y() : -way.y()) < kOwnLane;
  return own_side == (along > 0) ? logit(kShareOfSide) : -logit(kShareOfSide);
}

/// Whether neither its motion nor anything else of its own tells its front.
bool isUntold(const SceneObject& o) {
  constexpr double kStands = 0.5;  // [m/s]
  return o.p_front < kSureFront && std::abs(o.speed) < std::max(kStands, 2 * o.sd_speed);
}

void turn(double log_odds, SceneObject& o) {
  constexpr double kLeast = 1e-3;
  const double sum = logit(std::clamp(o.p_front, kLeast, 1 - kLeast)) + log_odds;
  if (sum < 0) {
    o.yaw = wrapAngle(o.yaw + kPi);
    o.speed = -o.speed;
  }
  o.p_front = std::min(kMostByOthers, 1 / (1 + std::exp(-std::abs(sum))));
}

}  // namespace

void turnUntoldFronts(const EgoState& ego, TrafficSide traffic, const ClassTable& classes,
                      std::vector<SceneObject>& objects) {
  // Who is turned is never known, so the order of the objects does not matter.
  for (SceneObject& o : objects) {
    if (!hasFront(o, classes) || !isUntold(o)) continue;
    const double row = rowLogOdds(o, classes, objects);
    const double log_odds = row != 0 ? row : sideLogOdds(o, ego, traffic);
    if (log_odds != 0) turn(log_odds, o);
  }
}

}  // namespace perception
