#include "libperception/sensors/satellites/FirstHeading.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace perception {

namespace {

constexpr double kSameFix = 0.06;             // [s] largest time between fixes of two antennas
constexpr double kLeastBaseline = 0.5;        // [m] least distance of two antennas
constexpr double kHeadingSigma = radians(8);  // [rad] largest deviation of a first heading
constexpr double kLeastCourseSpeed = 2;       // [m/s] least speed of a valid course
constexpr double kStraight = radians(5);      // [rad] deviation of a path without wheels
constexpr double kReference = 10;             // [s] longest path without wheels

double squared(double x) { return x * x; }

// `turn` [rad]: rotation from the start frame to east, north, up.
void setHeading(EgoMotionState& state, const GnssFix& fix, const Vector3& enu, double turn,
                double sigma, const FusionParams& params) {
  EgoEstimate& e = state.estimate;
  const double level = fix.has_height ? squared(fix.height_sigma) : 1e4;
  const Pose3 start = e.pose();
  const Pose3 T_enu_start = makePose(0, 0, 0, turn);
  // The antenna of the rotated vehicle is at the fix.
  const Vector3 arm = T_enu_start * (start.linear() * fix.antenna);
  Vector3 place = enu - arm;
  if (!fix.has_height) place.z() = 0;
  Pose3 T_enu_world = T_enu_start;
  T_enu_world.translation() = place - T_enu_start * start.translation();
  if (state.stamp - state.first <= params.heading_wait) {
    ++state.relocations;
    state.T_world_start = T_enu_world;
    e.x.segment<3>(kEgoX) = place;
    e.x[kEgoYaw] = wrapAngle(e.x[kEgoYaw] + turn);
  } else {  // too late: keep the world frame, transform the fixes
    state.world_turn = wrapAngle(turn);
    state.world_shift = T_enu_world.translation();
  }
  // The position is that of the fix alone; other components keep their covariance.
  for (const int axis : {kEgoX, kEgoY, kEgoZ}) {
    e.P.row(axis).setZero();
    e.P.col(axis).setZero();
  }
  e.P(kEgoX, kEgoX) = e.P(kEgoY, kEgoY) = squared(fix.sigma);
  e.P(kEgoZ, kEgoZ) = level;
  e.P(kEgoYaw, kEgoYaw) += squared(sigma);
  state.heading_known = true;
  ++state.fixes;
}

}  // namespace

void findHeading(EgoMotionState& state, const GnssFix& fix, const Vector3& enu,
                 const FusionParams& params) {
  const EgoVector& x = state.estimate.x;
  const auto direction = [](const Vector2& v) { return std::atan2(v.y(), v.x()); };
  const EgoMotionState::Reference here{state.stamp, enu,         x.head<2>(),
                                       x[kEgoYaw],  fix.antenna, fix.sigma};
  const auto last = std::exchange(state.last_fix, here);
  if (fix.yaw) return setHeading(state, fix, enu, *fix.yaw - x[kEgoYaw], fix.yaw_sigma, params);
  // Two antennas at one instant.
  if (last && state.stamp - last->stamp <= kSameFix) {
    const Vector2 arm = (fix.antenna - last->antenna).head<2>();
    const double sigma = std::hypot(fix.sigma, last->sigma) / std::max(arm.norm(), 1e-3);
    const Vector2 seen = (enu - last->enu).head<2>();
    const bool one_vehicle = std::abs(seen.norm() - arm.norm()) < 5 * sigma * arm.norm();
    if (arm.norm() >= kLeastBaseline && sigma <= kHeadingSigma && one_vehicle) {
      return setHeading(state, fix, enu, direction(seen) - direction(arm) - x[kEgoYaw], sigma,
                        params);
    }
  }
  // The course over ground.
  if (fix.has_velocity && fix.velocity.norm() >= kLeastCourseSpeed) {
    const double sigma = std::hypot(fix.velocity_sigma / fix.velocity.norm(), radians(2));
    const double back = state.had_wheels && x[kEgoSpeed] < 0 ? kPi : 0;
    if (sigma <= kHeadingSigma)
      return setHeading(state, fix, enu, direction(fix.velocity) + back - x[kEgoYaw], sigma,
                        params);
  }
  // The path since an earlier fix, by GNSS and by odometry.
  if (!state.reference ||
      (!state.had_wheels && state.stamp - state.reference->stamp > kReference)) {
    state.reference = here;
    return;
  }
  const auto& from = *state.reference;
  const double time = state.stamp - from.stamp;
  const Vector2 seen = (enu - from.enu).head<2>();
  Vector2 driven = Vector2(x.head<2>()) - from.place + rotate2(x[kEgoYaw], fix.antenna.head<2>()) -
                   rotate2(from.yaw, from.antenna.head<2>());
  double sigma = std::hypot(fix.sigma, from.sigma);
  if (state.had_wheels) {
    sigma = std::hypot(sigma / std::max(driven.norm(), 1e-3), params.gyro_bias_sigma * time / 2);
  } else {
    driven = rotate2(x[kEgoYaw], Vector2::UnitX());
    sigma = std::hypot(sigma / std::max(seen.norm(), 1e-3), kStraight);
  }
  if (sigma <= kHeadingSigma)
    setHeading(state, fix, enu, direction(seen) - direction(driven), sigma, params);
}

}  // namespace perception
