#include "libperception/sensors/ego/CEgoFilter.h"

#include <gtest/gtest.h>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

EgoVector someState(Rng& rng) {
  EgoVector x;
  for (int i = 0; i < kEgoAxes; ++i) x[i] = rng.normal();
  x[kEgoPitch] *= 0.2, x[kEgoRoll] *= 0.2;
  x[kEgoSpeed] *= 10;
  x.segment<3>(kEgoGyroX) *= 0.02;
  return x;
}

EgoInput someInput(Rng& rng, bool gyro, bool accelerometer) {
  EgoInput input;
  input.dt = 0.05;
  input.rates = 0.3 * Vector3(rng.normal(), rng.normal(), rng.normal());
  input.force = rng.normal();
  input.gyro = gyro, input.accelerometer = accelerometer;
  input.level_time = rng.uniform() < 0.5 ? 3 : 0;
  input.noise.setConstant(1e-3);
  return input;
}

TEST(CEgoFilter, JacobianIsTheDerivativeOfTheMotion) {
  Rng rng({1, 2, 3, 4});
  for (int n = 0; n < 40; ++n) {
    const EgoVector x = someState(rng);
    const EgoInput input = someInput(rng, n % 2 == 0, n % 4 < 2);
    const EgoMatrix F = CEgoFilter::jacobian(x, input);
    for (int i = 0; i < kEgoAxes; ++i) {
      constexpr double kStep = 1e-5;
      EgoVector up = x, down = x;
      up[i] += kStep, down[i] -= kStep;
      const EgoVector numeric =
          (CEgoFilter::moved(up, input) - CEgoFilter::moved(down, input)) / (2 * kStep);
      EXPECT_LT((F.col(i) - numeric).cwiseAbs().maxCoeff(), 1e-7) << "axis " << i;
    }
  }
}

// The library's iteration against the textbook's equations, constants included.
TEST(CEgoFilter, IsTheKalmanFilterOfAllAxes) {
  Rng rng({5, 6, 7, 8});
  CEgoFilter filter;
  EgoEstimate e;
  e.x = someState(rng);
  EgoMatrix A;
  for (int i = 0; i < A.size(); ++i) A.data()[i] = 0.3 * rng.normal();
  e.P = A * A.transpose() + EgoMatrix::Identity() * 0.1;
  for (int n = 0; n < 10; ++n) {
    const EgoEstimate before = e;
    const EgoInput input = someInput(rng, true, true);
    filter.predict(e, input);
    const EgoMatrix F = CEgoFilter::jacobian(before.x, input);
    const EgoMatrix P =
        F * before.P * F.transpose() + EgoMatrix((input.dt * input.noise).asDiagonal());
    EXPECT_LT((e.P - P).cwiseAbs().maxCoeff(), 1e-10);
    const EgoVector moved = CEgoFilter::moved(before.x, input);
    for (int i = 0; i < kEgoAxes; ++i) {
      const bool angle = i == kEgoYaw || i == kEgoPitch || i == kEgoRoll;
      EXPECT_NEAR(angle ? wrapAngle(e.x[i] - moved[i]) : e.x[i] - moved[i], 0, 1e-12);
    }
    EgoObservation o;
    o.rows = 2;
    for (int i = 0; i < 2 * kEgoAxes; ++i) o.H(i % 2, i / 2) = rng.normal();
    o.z << rng.normal(), rng.normal(), 0;
    o.variance << 0.5, 0.2, 1;
    const EgoEstimate predicted = e;
    ASSERT_TRUE(filter.update(e, o));
    const Eigen::Matrix3d R = o.variance.asDiagonal();
    const Eigen::Matrix3d S = o.H * predicted.P * o.H.transpose() + R;
    const Eigen::Matrix<double, kEgoAxes, 3> K = predicted.P * o.H.transpose() * S.inverse();
    EXPECT_NEAR(filter.nis(), (o.z - o.h).dot(S.inverse() * (o.z - o.h)), 1e-8);
    EXPECT_LT((e.P - (EgoMatrix::Identity() - K * o.H) * predicted.P).cwiseAbs().maxCoeff(), 1e-9);
    const EgoVector x = predicted.x + K * (o.z - o.h);
    EXPECT_NEAR(e.x[kEgoWheel], x[kEgoWheel], 1e-10);
    EXPECT_NEAR(e.x[kEgoX], x[kEgoX], 1e-10);
    EXPECT_NEAR(wrapAngle(e.x[kEgoYaw] - x[kEgoYaw]), 0, 1e-10);
  }
}

TEST(CEgoFilter, WhatTheGateRejectsChangesNothing) {
  CEgoFilter filter;
  EgoEstimate e;
  e.P.setIdentity();
  EgoObservation o;
  o.rows = 1;
  o.z[0] = 10;
  o.H(0, kEgoX) = 1;
  o.variance[0] = 1;
  o.gate = 16;  // the NIS is 100 / 2
  EXPECT_FALSE(filter.update(e, o));
  EXPECT_NEAR(filter.nis(), 50, 1e-9);
  EXPECT_EQ(e.x, EgoVector(EgoVector::Zero()));
  EXPECT_EQ(e.P, EgoMatrix(EgoMatrix::Identity()));
}

TEST(CEgoFilter, AnglesAreSeenTheShortWayRound) {
  CEgoFilter filter;
  EgoEstimate e;
  e.P.setIdentity();
  e.x[kEgoYaw] = 3.1;
  EgoObservation o;
  o.rows = 1;
  o.angle = true;
  o.z[0] = -3.1;
  o.h[0] = 3.1;
  o.H(0, kEgoYaw) = 1;
  o.variance[0] = 1e-9;
  ASSERT_TRUE(filter.update(e, o));
  EXPECT_NEAR(e.x[kEgoYaw], -3.1, 1e-6);
}

}  // namespace
}  // namespace perception
