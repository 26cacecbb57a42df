#include "libperception/sensors/satellites/GnssUpdate.h"

#include <cmath>

#include "libperception/core/math/Chi2.h"

namespace perception {

namespace {

constexpr double kGate = 0.9999;      // probability of the gate of a fix
constexpr int kRelocationFixes = 10;  // consecutive rejected fixes after which they are accepted

double squareOf(double x) { return x * x; }

/// Observation of the antenna's position [m, world], including its lever arm.
EgoObservation antennaObservation(const EgoVector& x, const GnssFix& fix, const Vector3& world) {
  const auto antennaAt = [&](double yaw, double pitch, double roll) -> Vector3 {
    return makePose(x[kEgoX], x[kEgoY], x[kEgoZ], yaw, pitch, roll) * fix.antenna;
  };
  const double yaw = x[kEgoYaw], pitch = x[kEgoPitch], roll = x[kEgoRoll];
  EgoObservation both;
  both.z = world;
  both.h = antennaAt(yaw, pitch, roll);
  both.H.block<3, 3>(0, kEgoX).setIdentity();
  constexpr double kStep = 1e-4;  // [rad] of numerical derivatives of the lever arm
  both.H.col(kEgoYaw) =
      (antennaAt(yaw + kStep, pitch, roll) - antennaAt(yaw - kStep, pitch, roll)) / (2 * kStep);
  both.H.col(kEgoPitch) =
      (antennaAt(yaw, pitch + kStep, roll) - antennaAt(yaw, pitch - kStep, roll)) / (2 * kStep);
  both.H.col(kEgoRoll) =
      (antennaAt(yaw, pitch, roll + kStep) - antennaAt(yaw, pitch, roll - kStep)) / (2 * kStep);
  return both;
}

}  // namespace

bool updatePlace(CEgoFilter& filter, EgoMotionState& state, const GnssFix& fix,
                 const Vector3& world) {
  const EgoVector& x = state.estimate.x;
  const EgoObservation both = antennaObservation(x, fix, world);
  static const double gate1 = chi2Quantile(kGate, 1), gate2 = chi2Quantile(kGate, 2);
  EgoObservation place = both;
  place.rows = 2;
  place.H.row(2).setZero();
  place.z[2] = place.h[2] = 0;
  place.variance << squareOf(fix.sigma), squareOf(fix.sigma), 1;
  place.gate = gate2;
  EgoObservation height;
  height.rows = 1;
  height.z[0] = both.z[2], height.h[0] = both.h[2];
  height.H.row(0) = both.H.row(2);
  height.variance[0] = squareOf(fix.height_sigma);
  height.gate = gate1;
  const Vector3 arm = both.h - x.segment<3>(kEgoX);
  // After consistent rejected fixes the state is reset to them.
  const auto moveTo = [&](int axis, double value, double sigma) {
    state.estimate.x[axis] = value;
    state.estimate.P.row(axis).setZero();
    state.estimate.P.col(axis).setZero();
    state.estimate.P(axis, axis) = squareOf(sigma);
  };
  const EgoVector before = x;
  const bool taken = filter.update(state.estimate, place);
  if (taken) {
    state.rejected_in_row = 0;
    ++state.fixes;
  } else {
    ++state.rejected_fixes;
    if (++state.rejected_in_row < kRelocationFixes) return false;
    state.rejected_in_row = 0;
    moveTo(kEgoX, world.x() - arm.x(), fix.sigma);
    moveTo(kEgoY, world.y() - arm.y(), fix.sigma);
  }
  if (!fix.has_height) return true;
  height.h[0] += height.H.row(0).dot(x - before);
  if (filter.update(state.estimate, height)) {
    state.rejected_heights_in_row = 0;
  } else if (++state.rejected_heights_in_row >= kRelocationFixes) {
    state.rejected_heights_in_row = 0;
    moveTo(kEgoZ, world.z() - arm.z(), fix.height_sigma);
  }
  return true;
}

void updateVelocity(CEgoFilter& filter, EgoMotionState& state, const GnssFix& fix,
                    double yaw_rate) {
  const EgoVector& x = state.estimate.x;
  const double c = std::cos(x[kEgoYaw]), s = std::sin(x[kEgoYaw]);
  // Velocity of the lever arm by rotation about the rear axle.
  const Vector2 swing = rotate2(x[kEgoYaw], yaw_rate * Vector2(-fix.antenna.y(), fix.antenna.x()));
  EgoObservation o;
  o.rows = 2;
  o.z.head<2>() = rotate2(-state.world_turn, fix.velocity);
  o.h.head<2>() = x[kEgoSpeed] * Vector2(c, s) + swing;
  o.H(0, kEgoSpeed) = c, o.H(1, kEgoSpeed) = s;
  o.H(0, kEgoYaw) = -o.h[1], o.H(1, kEgoYaw) = o.h[0];
  o.variance.head<2>().setConstant(squareOf(fix.velocity_sigma));
  static const double gate = chi2Quantile(kGate, 2);
  o.gate = gate;
  filter.update(state.estimate, o);
}

void updateYaw(CEgoFilter& filter, EgoMotionState& state, double yaw, double sigma) {
  EgoObservation o;
  o.rows = 1;
  o.angle = true;
  o.z[0] = yaw;
  o.h[0] = state.estimate.x[kEgoYaw];
  o.H(0, kEgoYaw) = 1;
  o.variance[0] = squareOf(sigma);
  static const double gate = chi2Quantile(kGate, 1);
  o.gate = gate;
  filter.update(state.estimate, o);
}

}  // namespace perception
