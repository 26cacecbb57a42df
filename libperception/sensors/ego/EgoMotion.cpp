#include "libperception/sensors/ego/EgoMotion.h"

#include <algorithm>
#include <cmath>

#include "libperception/sensors/satellites/FirstHeading.h"
#include "libperception/sensors/satellites/GnssUpdate.h"

namespace perception {

namespace {

constexpr double kValidity = 0.15;         // [s] validity of a reading of gyros or wheels
constexpr double kLongestStep = 0.1;       // [s] of one prediction
constexpr double kStandstillSpeed = 0.02;  // [m/s] largest speed at standstill
constexpr double kLevelEvery = 0.1;        // [s] between updates by the lateral force
constexpr double kImuRate = 100;           // [1/s] readings of gyros, for one reading's noise
// Process noise without gyros or accelerometer.
constexpr double kTurnNoise = radians(15), kWheelTurnNoise = radians(1.5);  // [rad/sqrt(s)]
constexpr double kAccelerationNoise = 2;                                    // [m/s^2 sqrt(s)]
constexpr double kRoadSlope = radians(3), kSlopeTime = 2;  // [rad], [s] pitch and roll of roads
constexpr double kFreeLevelTime = 20;      // [s] to level, gyros without accelerometer
constexpr double kScaleWalk = 1e-4;        // [1/sqrt(s)]
constexpr double kInitialSpeedSigma = 15;  // [m/s] initial deviation

double square(double x) { return x * x; }

}  // namespace

EgoMotionState EgoMotion::after(const EgoMotionState& before, Stamp stamp,
                                const EgoReading& reading) {
  EgoMotionState state = before;
  if (!state.started) start(state, stamp);
  // An inertial reading is of the interval before it, so it applies from the previous one on.
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
  variance[kEgoSpeed] = square(kInitialSpeedSigma);
  variance.segment<3>(kEgoGyroX).setConstant(square(params_.gyro_bias_sigma));
  variance[kEgoWheel] = square(params_.wheel_scale_sigma);
  variance[kEgoAccel] = variance[kAccelBiasY] = square(params_.accel_bias_sigma);
  state.estimate.P = variance.asDiagonal();
}

// ---- Motion.

bool EgoMotion::isStationary(const EgoMotionState& state, Stamp stamp) const {
  return state.wheels && stamp - state.wheels->first <= kValidity &&
         std::abs(state.wheels->second.speed) < kStandstillSpeed;
}

EgoInput EgoMotion::inputAt(const EgoMotionState& state, Stamp stamp) const {
  EgoInput input;
  EgoVector& noise = input.noise;
  noise.segment<3>(kEgoGyroX).setConstant(square(params_.gyro_bias_walk));
  noise[kEgoWheel] = square(kScaleWalk);
  noise[kEgoAccel] = noise[kAccelBiasY] = square(params_.accel_bias_walk);
  if (isStationary(state, stamp)) {                 // zero-velocity update
    noise[kEgoSpeed] = square(kAccelerationNoise);  // may start at any time
    noise[kEgoYaw] = square(radians(0.01));
    return input;
  }
  noise.segment<3>(kEgoX).setConstant(square(params_.slip));
  const auto* imu =
      state.imu && stamp - state.imu->first <= kValidity ? &state.imu->second : nullptr;
  const auto* wheels =
      state.wheels && stamp - state.wheels->first <= kValidity ? &state.wheels->second : nullptr;
  if (imu != nullptr && imu->gyro) {
    input.gyro = true;
    input.rates = imu->rates;
    noise.segment<3>(kEgoYaw).setConstant(square(params_.gyro_noise));
    if (!imu->accelerometer) input.level_time = kFreeLevelTime;
  } else {
    const bool turns = wheels != nullptr && wheels->yaw_rate;
    input.rates.z() = turns ? *wheels->yaw_rate : 0;
    noise[kEgoYaw] = square(turns ? kWheelTurnNoise : kTurnNoise);
    input.level_time = kSlopeTime;
    noise[kEgoPitch] = noise[kEgoRoll] = 2 * square(kRoadSlope) / kSlopeTime;
  }
  if (imu != nullptr && imu->accelerometer) {
    input.accelerometer = true;
    input.force = imu->force.x();
    noise[kEgoSpeed] = square(params_.accel_noise);
  } else {
    noise[kEgoSpeed] = square(kAccelerationNoise);
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
  if (state.imu && state.stamp - state.imu->first <= kValidity && state.imu->second.gyro)
    return state.imu->second.rates.z() - state.estimate.x[kEgoGyroZ];
  if (state.wheels && state.stamp - state.wheels->first <= kValidity)
    return state.wheels->second.yaw_rate.value_or(0);
  return 0;
}

// ---- Readings.

void EgoMotion::apply(EgoMotionState& state, const ImuReading& imu) {
  if (imu.gyro && isStationary(state, state.stamp)) {
    EgoObservation o;  // at rest gyros measure their biases
    o.rows = 3;
    o.z = imu.rates;
    o.h = state.estimate.x.segment<3>(kEgoGyroX);
    o.H.block<3, 3>(0, kEgoGyroX).setIdentity();
    o.variance.setConstant(square(params_.gyro_noise) * kImuRate);
    filter_.update(state.estimate, o);
  }
  if (imu.accelerometer) updateAttitude(state, imu);
}

// Uses the mean over a tenth of a second: single readings are too noisy.
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
  EgoObservation side;  // lateral force: turn rate and gravity
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
  EgoObservation ahead;  // forward force at rest: gravity and bias
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
  // At standstill the deviation of the speed is at most kStandstillSpeed.
  const bool stand = std::abs(wheels.speed) < kStandstillSpeed;
  o.variance[0] =
      square(stand ? std::min(kStandstillSpeed, params_.wheel_sigma) : params_.wheel_sigma);
  filter_.update(state.estimate, o);
}

void EgoMotion::apply(EgoMotionState& state, const GnssFix& fix) {
  if (!state.origin) {
    // Height 0 of the world frame is the road below the antenna.
    state.origin = fix.place;
    state.origin->height -= fix.antenna.z();
  }
  const Vector3 enu = LocalFrame(*state.origin).fromGeodetic(fix.place);
  if (!enu.allFinite()) return;
  if (!state.heading_known) {
    findHeading(state, fix, enu, params_);
    return;
  }
  if (!updatePlace(filter_, state, fix, state.toWorld(enu))) return;
  if (fix.has_velocity) updateVelocity(filter_, state, fix, yawRate(state));
  if (fix.yaw) updateYaw(filter_, state, wrapAngle(*fix.yaw - state.world_turn), fix.yaw_sigma);
}

}  // namespace perception
