#include "libperception/sensors/EgoMotion.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/Chi2.h"

namespace perception {

namespace {

constexpr double kHeld = 0.15;          // [s] a reading of gyros or wheels holds so long
constexpr double kLongestStep = 0.1;    // [s] of one prediction
constexpr double kStanding = 0.02;      // [m/s] wheels that turn no faster stand
constexpr double kLevelEvery = 0.1;     // [s] between looks at the sideways force
constexpr double kImuRate = 100;        // [1/s] readings of gyros, for one reading's noise
constexpr double kGate = 0.9999;        // of the NIS of a fix
constexpr int kRelocation = 10;         // rejected fixes in a row after which they are believed
constexpr double kSameFix = 0.06;       // [s] fixes of two antennas are of one instant
constexpr double kLeastBaseline = 0.5;  // [m] between two antennas
constexpr double kHeadingSigma = radians(8);  // [rad] a first heading is not taken below it
constexpr double kCourseSpeed = 2;            // [m/s] from which a course is a heading
constexpr double kStraight = radians(5);      // [rad] a way without wheels is as straight
constexpr double kReference = 10;             // [s] after which a way starts anew (without wheels)
// Without gyros or accelerometer: what a vehicle may do.
constexpr double kAnyTurn = radians(15), kWheelTurn = radians(1.5);  // [rad/sqrt(s)]
constexpr double kAnyAcceleration = 2;                               // [m/s^2 sqrt(s)]
constexpr double kRoadSlope = radians(3), kSlopeTime = 2;  // [rad], [s] pitch and roll of roads
constexpr double kFreeLevelTime = 20;  // [s] gyros without accelerometer go back to level
constexpr double kScaleWalk = 1e-4;    // [1/sqrt(s)]
constexpr double kAnySpeed = 15;       // [m/s] before anything is known

double square(double x) { return x * x; }

}  // namespace

void FusionParams::visit(ParamVisitor& v) {
  gnss.visit(v);
  v.angle("gyro_noise_deg", gyro_noise, {1e-6, 10}, "angle random walk, in one second");
  v.angle("gyro_bias_sigma_deg", gyro_bias_sigma, {0, 20}, "rate of a gyro at rest, per second");
  v.real("accel_noise", accel_noise, {1e-6, 10}, "m/s", "velocity random walk, in one second");
  v.real("accel_bias_sigma", accel_bias_sigma, {0, 5}, "m/s^2", "bias of the accelerometer");
  v.real("wheel_sigma", wheel_sigma, {0.001, 5}, "m/s", "of one reading of the wheels");
  v.real("wheel_scale_sigma", wheel_scale_sigma, {0, 0.5}, "-", "their scale: tyres, pressure");
  v.real("heading_wait", heading_wait, {0, 600}, "s",
         "for a heading, before the world stays the frame of the start");
  v.reals("origin", origin, -1, {-1e4, 1e4}, "deg, deg, m",
          "latitude, longitude, height of the world's origin; empty: the first fix");
  v.require(origin.empty() || origin.size() == 3,
            "origin: expected latitude, longitude and height");
  v.expert();
  v.text("gnss_label", gnss_label, "label of the receivers' observations; empty: all");
  v.text("imu_label", imu_label, "label of the inertial unit's observations; empty: all");
  v.text("wheels_label", wheels_label, "label of the wheels' odometry; empty: all");
  v.real("late", late, {0, 10}, "s", "at most an observation of these sensors may come late");
}

Vector3 EgoMotionState::toWorld(const Vector3& enu) const {
  Vector3 p = enu - world_shift;
  p.head<2>() = rotate2(-world_turn, p.head<2>());
  return p;
}

EgoMotionState EgoMotion::after(const EgoMotionState& before, Stamp stamp,
                                const EgoReading& reading) {
  EgoMotionState state = before;
  if (!state.started) start(state, stamp);
  // An inertial reading tells of the time before it, so it is in force from the last one on.
  if (const auto* imu = std::get_if<ImuReading>(&reading)) state.imu = {stamp, *imu};
  advance(state, stamp);
  std::visit([&](const auto& r) { apply(state, r); }, reading);
  return state;
}

void EgoMotion::start(EgoMotionState& state, Stamp stamp) const {
  state.started = true;
  state.first = state.stamp = stamp;
  if (params_.origin.size() == 3)
    state.origin = Geodetic{params_.origin[0], params_.origin[1], params_.origin[2]};
  EgoVector variance = EgoVector::Zero();
  variance[kEgoPitch] = variance[kEgoRoll] = square(kRoadSlope);
  variance[kEgoSpeed] = square(kAnySpeed);
  variance.segment<3>(kEgoGyroX).setConstant(square(params_.gyro_bias_sigma));
  variance[kEgoWheel] = square(params_.wheel_scale_sigma);
  variance[kEgoAccel] = variance[kAccelBiasY] = square(params_.accel_bias_sigma);
  state.estimate.P = variance.asDiagonal();
}

// ---- Motion.

bool EgoMotion::isStationary(const EgoMotionState& state, Stamp stamp) const {
  return state.wheels && stamp - state.wheels->first <= kHeld &&
         std::abs(state.wheels->second.speed) < kStanding;
}

EgoInput EgoMotion::inputAt(const EgoMotionState& state, Stamp stamp) const {
  EgoInput input;
  EgoVector& noise = input.noise;
  noise.segment<3>(kEgoGyroX).setConstant(square(params_.gyro_bias_walk));
  noise[kEgoWheel] = square(kScaleWalk);
  noise[kEgoAccel] = noise[kAccelBiasY] = square(params_.accel_bias_walk);
  if (isStationary(state, stamp)) {               // nothing moves, whatever the gyros say
    noise[kEgoSpeed] = square(kAnyAcceleration);  // it may start at any time
    noise[kEgoYaw] = square(radians(0.01));
    return input;
  }
  noise.segment<3>(kEgoX).setConstant(square(params_.slip));
  const auto* imu = state.imu && stamp - state.imu->first <= kHeld ? &state.imu->second : nullptr;
  const auto* wheels =
      state.wheels && stamp - state.wheels->first <= kHeld ? &state.wheels->second : nullptr;
  if (imu != nullptr && imu->gyro) {
    input.gyro = true;
    input.rates = imu->rates;
    noise.segment<3>(kEgoYaw).setConstant(square(params_.gyro_noise));
    if (!imu->accelerometer) input.level_time = kFreeLevelTime;
  } else {
    const bool turns = wheels != nullptr && wheels->yaw_rate;
    input.rates.z() = turns ? *wheels->yaw_rate : 0;
    noise[kEgoYaw] = square(turns ? kWheelTurn : kAnyTurn);
    input.level_time = kSlopeTime;
    noise[kEgoPitch] = noise[kEgoRoll] = 2 * square(kRoadSlope) / kSlopeTime;
  }
  if (imu != nullptr && imu->accelerometer) {
    input.accelerometer = true;
    input.force = imu->force.x();
    noise[kEgoSpeed] = square(params_.accel_noise);
  } else {
    noise[kEgoSpeed] = square(kAnyAcceleration);
  }
  return input;
}

void EgoMotion::advance(EgoMotionState& state, Stamp stamp) {
  while (state.stamp < stamp) {
    const double left = stamp - state.stamp;
    const Stamp next = left > 1.5 * kLongestStep ? state.stamp + kLongestStep : stamp;
    EgoInput input = inputAt(state, next);
    input.dt = next - state.stamp;
    filter_.predict(state.estimate, input);
    state.stamp = next;
  }
}

double EgoMotion::yawRate(const EgoMotionState& state) const {
  if (isStationary(state, state.stamp)) return 0;
  if (state.imu && state.stamp - state.imu->first <= kHeld && state.imu->second.gyro)
    return state.imu->second.rates.z() - state.estimate.x[kEgoGyroZ];
  if (state.wheels && state.stamp - state.wheels->first <= kHeld)
    return state.wheels->second.yaw_rate.value_or(0);
  return 0;
}

// ---- Readings.

void EgoMotion::apply(EgoMotionState& state, const ImuReading& imu) {
  if (imu.gyro && isStationary(state, state.stamp)) {
    EgoObservation o;  // at rest the gyros show their biases
    o.rows = 3;
    o.z = imu.rates;
    o.h = state.estimate.x.segment<3>(kEgoGyroX);
    o.H.block<3, 3>(0, kEgoGyroX).setIdentity();
    o.variance.setConstant(square(params_.gyro_noise) * kImuRate);
    filter_.update(state.estimate, o);
  }
  if (imu.accelerometer) updateAttitude(state, imu);
}

// The mean of a tenth of a second: single readings shake.
void EgoMotion::updateAttitude(EgoMotionState& state, const ImuReading& imu) {
  auto& sum = state.level;
  ++sum.count;
  sum.force += imu.force;
  sum.turning += imu.rates.z();
  if (!sum.begin) sum.begin = state.stamp;
  const double time = state.stamp - *sum.begin;
  if (time < kLevelEvery) return;
  const Vector3 force = sum.force / sum.count;
  const double turning = sum.turning / sum.count;
  sum = {};
  sum.begin = state.stamp;
  const EgoVector& x = state.estimate.x;
  const bool stands = isStationary(state, state.stamp);
  const double rate = stands || !imu.gyro ? yawRate(state) : turning - x[kEgoGyroZ];
  const double cp = std::cos(x[kEgoPitch]), sp = std::sin(x[kEgoPitch]);
  const double cr = std::cos(x[kEgoRoll]), sr = std::sin(x[kEgoRoll]);
  EgoObservation side;  // turning and gravity
  side.rows = 1;
  side.z[0] = force.y();
  side.h[0] = x[kEgoSpeed] * rate + kGravity * cp * sr + x[kAccelBiasY];
  side.H(0, kEgoSpeed) = rate;
  side.H(0, kEgoGyroZ) = stands ? 0 : -x[kEgoSpeed];
  side.H(0, kEgoPitch) = -kGravity * sp * sr;
  side.H(0, kEgoRoll) = kGravity * cp * cr;
  side.H(0, kAccelBiasY) = 1;
  side.variance[0] = square(params_.level_sigma) + square(params_.accel_noise) / time;
  filter_.update(state.estimate, side);
  if (!stands) return;
  EgoObservation ahead;  // at rest: gravity and bias
  ahead.rows = 1;
  ahead.z[0] = force.x();
  ahead.h[0] = x[kEgoAccel] - kGravity * std::sin(x[kEgoPitch]);
  ahead.H(0, kEgoAccel) = 1;
  ahead.H(0, kEgoPitch) = -kGravity * std::cos(x[kEgoPitch]);
  ahead.variance = side.variance;
  filter_.update(state.estimate, ahead);
}

void EgoMotion::apply(EgoMotionState& state, const WheelReading& wheels) {
  state.wheels = {state.stamp, wheels};
  state.had_wheels = true;
  const double v = state.estimate.x[kEgoSpeed], scale = 1 + state.estimate.x[kEgoWheel];
  EgoObservation o;
  o.rows = 1;
  o.z[0] = wheels.speed;
  o.h[0] = scale * v;
  o.H(0, kEgoSpeed) = scale;
  o.H(0, kEgoWheel) = v;
  // Wheels that stand are known to stand.
  const bool stand = std::abs(wheels.speed) < kStanding;
  o.variance[0] = square(stand ? std::min(kStanding, params_.wheel_sigma) : params_.wheel_sigma);
  filter_.update(state.estimate, o);
}

void EgoMotion::apply(EgoMotionState& state, const GnssFix& fix) {
  if (!state.origin) {
    // The world's ground is the road below the antenna.
    state.origin = fix.place;
    state.origin->height -= fix.antenna.z();
  }
  const Vector3 enu = LocalFrame(*state.origin).fromGeodetic(fix.place);
  if (!enu.allFinite()) return;
  if (!state.heading_known) {
    findHeading(state, fix, enu);
    return;
  }
  if (!updatePlace(state, fix, state.toWorld(enu))) return;
  if (fix.has_velocity) updateVelocity(state, fix);
  if (fix.yaw) updateYaw(state, wrapAngle(*fix.yaw - state.world_turn), fix.yaw_sigma);
}

// Place and height apart: receivers whose base stations differ agree in place and not in height.
bool EgoMotion::updatePlace(EgoMotionState& state, const GnssFix& fix, const Vector3& world) {
  const EgoVector& x = state.estimate.x;
  const auto antennaAt = [&](double yaw, double pitch, double roll) -> Vector3 {
    return makePose(x[kEgoX], x[kEgoY], x[kEgoZ], yaw, pitch, roll) * fix.antenna;
  };
  const double yaw = x[kEgoYaw], pitch = x[kEgoPitch], roll = x[kEgoRoll];
  EgoObservation both;
  both.z = world;
  both.h = antennaAt(yaw, pitch, roll);
  both.H.block<3, 3>(0, kEgoX).setIdentity();
  constexpr double kStep = 1e-4;  // [rad] of the lever arm's derivatives
  both.H.col(kEgoYaw) =
      (antennaAt(yaw + kStep, pitch, roll) - antennaAt(yaw - kStep, pitch, roll)) / (2 * kStep);
  both.H.col(kEgoPitch) =
      (antennaAt(yaw, pitch + kStep, roll) - antennaAt(yaw, pitch - kStep, roll)) / (2 * kStep);
  both.H.col(kEgoRoll) =
      (antennaAt(yaw, pitch, roll + kStep) - antennaAt(yaw, pitch, roll - kStep)) / (2 * kStep);
  static const double gate1 = chi2Quantile(kGate, 1), gate2 = chi2Quantile(kGate, 2);
  EgoObservation place = both;
  place.rows = 2;
  place.H.row(2).setZero();
  place.z[2] = place.h[2] = 0;
  place.variance << square(fix.sigma), square(fix.sigma), 1;
  place.gate = gate2;
  EgoObservation height;
  height.rows = 1;
  height.z[0] = both.z[2], height.h[0] = both.h[2];
  height.H.row(0) = both.H.row(2);
  height.variance[0] = square(fix.height_sigma);
  height.gate = gate1;
  const Vector3 arm = both.h - x.segment<3>(kEgoX);
  // Rejected ones that agree with each other for longer than chance allows: the vehicle is there.
  const auto moveTo = [&](int axis, double value, double sigma) {
    state.estimate.x[axis] = value;
    state.estimate.P.row(axis).setZero();
    state.estimate.P.col(axis).setZero();
    state.estimate.P(axis, axis) = square(sigma);
  };
  const EgoVector before = x;
  const bool taken = filter_.update(state.estimate, place);
  if (taken) {
    state.rejected_in_row = 0;
    ++state.fixes;
  } else {
    ++state.rejected_fixes;
    if (++state.rejected_in_row < kRelocation) return false;
    state.rejected_in_row = 0;
    moveTo(kEgoX, world.x() - arm.x(), fix.sigma);
    moveTo(kEgoY, world.y() - arm.y(), fix.sigma);
  }
  if (!fix.has_height) return true;
  height.h[0] += height.H.row(0).dot(x - before);
  if (filter_.update(state.estimate, height)) {
    state.rejected_heights_in_row = 0;
  } else if (++state.rejected_heights_in_row >= kRelocation) {
    state.rejected_heights_in_row = 0;
    moveTo(kEgoZ, world.z() - arm.z(), fix.height_sigma);
  }
  return true;
}

void EgoMotion::updateVelocity(EgoMotionState& state, const GnssFix& fix) {
  const EgoVector& x = state.estimate.x;
  const double c = std::cos(x[kEgoYaw]), s = std::sin(x[kEgoYaw]), rate = yawRate(state);
  // The antenna swings about the rear axle.
  const Vector2 swing = rotate2(x[kEgoYaw], rate * Vector2(-fix.antenna.y(), fix.antenna.x()));
  EgoObservation o;
  o.rows = 2;
  o.z.head<2>() = rotate2(-state.world_turn, fix.velocity);
  o.h.head<2>() = x[kEgoSpeed] * Vector2(c, s) + swing;
  o.H(0, kEgoSpeed) = c, o.H(1, kEgoSpeed) = s;
  o.H(0, kEgoYaw) = -o.h[1], o.H(1, kEgoYaw) = o.h[0];
  o.variance.head<2>().setConstant(square(fix.velocity_sigma));
  static const double gate = chi2Quantile(kGate, 2);
  o.gate = gate;
  filter_.update(state.estimate, o);
}

void EgoMotion::updateYaw(EgoMotionState& state, double yaw, double sigma) {
  EgoObservation o;
  o.rows = 1;
  o.angle = true;
  o.z[0] = yaw;
  o.h[0] = state.estimate.x[kEgoYaw];
  o.H(0, kEgoYaw) = 1;
  o.variance[0] = square(sigma);
  static const double gate = chi2Quantile(kGate, 1);
  o.gate = gate;
  filter_.update(state.estimate, o);
}

// ---- The first heading.

void EgoMotion::findHeading(EgoMotionState& state, const GnssFix& fix, const Vector3& enu) const {
  const EgoVector& x = state.estimate.x;
  const auto direction = [](const Vector2& v) { return std::atan2(v.y(), v.x()); };
  const EgoMotionState::Reference here{state.stamp, enu,         x.head<2>(),
                                       x[kEgoYaw],  fix.antenna, fix.sigma};
  const auto last = std::exchange(state.last_fix, here);
  if (fix.yaw) return setHeading(state, fix, enu, *fix.yaw - x[kEgoYaw], fix.yaw_sigma);
  // Two antennas at one instant.
  if (last && state.stamp - last->stamp <= kSameFix) {
    const Vector2 arm = (fix.antenna - last->antenna).head<2>();
    const double sigma = std::hypot(fix.sigma, last->sigma) / std::max(arm.norm(), 1e-3);
    const Vector2 seen = (enu - last->enu).head<2>();
    const bool one_vehicle = std::abs(seen.norm() - arm.norm()) < 5 * sigma * arm.norm();
    if (arm.norm() >= kLeastBaseline && sigma <= kHeadingSigma && one_vehicle) {
      return setHeading(state, fix, enu, direction(seen) - direction(arm) - x[kEgoYaw], sigma);
    }
  }
  // The course over ground.
  if (fix.has_velocity && fix.velocity.norm() >= kCourseSpeed) {
    const double sigma = std::hypot(fix.velocity_sigma / fix.velocity.norm(), radians(2));
    const double back = state.had_wheels && x[kEgoSpeed] < 0 ? kPi : 0;
    if (sigma <= kHeadingSigma)
      return setHeading(state, fix, enu, direction(fix.velocity) + back - x[kEgoYaw], sigma);
  }
  // The way since an earlier fix, seen by satellites and by the vehicle itself.
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
    sigma = std::hypot(sigma / std::max(driven.norm(), 1e-3), params_.gyro_bias_sigma * time / 2);
  } else {
    driven = rotate2(x[kEgoYaw], Vector2::UnitX());
    sigma = std::hypot(sigma / std::max(seen.norm(), 1e-3), kStraight);
  }
  if (sigma <= kHeadingSigma)
    setHeading(state, fix, enu, direction(seen) - direction(driven), sigma);
}

// `turn` [rad] takes the frame of the start to east, north, up.
void EgoMotion::setHeading(EgoMotionState& state, const GnssFix& fix, const Vector3& enu,
                           double turn, double sigma) const {
  EgoEstimate& e = state.estimate;
  const double level = fix.has_height ? square(fix.height_sigma) : 1e4;
  const Pose3 start = e.pose();
  const Pose3 T_enu_start = makePose(0, 0, 0, turn);
  // The antenna of the turned vehicle stands where the fix is.
  const Vector3 arm = T_enu_start * (start.linear() * fix.antenna);
  Vector3 place = enu - arm;
  if (!fix.has_height) place.z() = 0;
  Pose3 T_enu_world = T_enu_start;
  T_enu_world.translation() = place - T_enu_start * start.translation();
  if (state.stamp - state.first <= params_.heading_wait) {
    ++state.relocations;
    state.T_world_start = T_enu_world;
    e.x.segment<3>(kEgoX) = place;
    e.x[kEgoYaw] = wrapAngle(e.x[kEgoYaw] + turn);
  } else {  // too late: the world stays, and fixes are turned into it
    state.world_turn = wrapAngle(turn);
    state.world_shift = T_enu_world.translation();
  }
  // The place is that of this one fix, the rest keeps what it knew.
  for (const int axis : {kEgoX, kEgoY, kEgoZ}) {
    e.P.row(axis).setZero();
    e.P.col(axis).setZero();
  }
  e.P(kEgoX, kEgoX) = e.P(kEgoY, kEgoY) = square(fix.sigma);
  e.P(kEgoZ, kEgoZ) = level;
  e.P(kEgoYaw, kEgoYaw) += square(sigma);
  state.heading_known = true;
  ++state.fixes;
}

}  // namespace perception
