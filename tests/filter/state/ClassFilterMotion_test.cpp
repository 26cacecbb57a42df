#include "libperception/filter/state/ClassFilterMotion.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "libperception/core/math/Random.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

ObjectClass wheeled() {
  ObjectClass c;
  c.name = "car";
  c.motion = findMotionModel("wheeled");
  c.accel_psd = 1.0;
  c.yaw_rate_psd = 0.0685;
  c.position_psd = 0.01;
  return c;
}

ClassFilter orientedFilter(double x, double y, double v, double theta) {
  ClassFilter f;
  f.x << x, y, v, theta;
  f.P.diagonal() << 0.2, 0.3, 0.5, 0.04;
  f.P(0, 2) = f.P(2, 0) = 0.05;
  f.P(1, 3) = f.P(3, 1) = -0.02;
  f.oriented = true;
  return f;
}

TEST(ConstantVelocity, StepsCompose) {
  const auto c = test::linearClasses()[0];
  ClassFilter once;
  once.x << 1, 2, 0.5, -0.3;
  once.P = 0.1 * Matrix4::Identity();
  ClassFilter twice = once;
  predictClassFilter(c, 0.7, once);
  predictClassFilter(c, 0.3, twice);
  predictClassFilter(c, 0.4, twice);
  EXPECT_LT((once.x - twice.x).norm(), 1e-12);
  EXPECT_LT((once.P - twice.P).norm(), 1e-12);
}

TEST(TwoSpeeds, AreTheirMixtureUntilOneIsBeyondDoubt) {
  const ObjectClass c = wheeled();
  ClassFilter f;
  f.P.diagonal() << 0.2, 0.2, 25, 25;
  startTwoSpeeds(0.1, 20, f);
  ASSERT_EQ(f.modes.size(), 2u);
  EXPECT_NEAR(f.P(2, 2), 0.9 * 25 + 0.1 * 400, 1e-12);
  ClassFilter slow = f;
  slow.modes.clear(), slow.P = f.modes[0].P;
  predictClassFilter(c, 0.1, f);
  predictClassFilter(c, 0.1, slow);
  EXPECT_LT((f.modes[0].P - slow.P).norm(), 1e-12) << "each moves as if it were alone";
  EXPECT_NEAR(std::exp(f.modes[1].log_probability), 0.1, 1e-12);
  settleSpeeds(c, f);
  ASSERT_EQ(f.modes.size(), 2u) << "0.9 is the prior, not beyond doubt";
  f.modes[0].log_probability = std::log(0.05), f.modes[1].log_probability = std::log(0.95);
  const Matrix4 fast = f.modes[1].P;
  settleSpeeds(c, f);
  EXPECT_TRUE(f.modes.empty());
  EXPECT_EQ(f.P, fast);
}

TEST(Wheeled, AFastVehicleCannotTurnAsASlowOne) {
  ObjectClass c = wheeled();
  c.lateral_psd = 4;
  EXPECT_EQ(c.yawRatePsd(7), c.yaw_rate_psd);
  EXPECT_DOUBLE_EQ(c.yawRatePsd(-20), 4.0 / 400);
  ClassFilter f = orientedFilter(0, 0, 20, 0);
  f.P.setZero();
  predictClassFilter(c, 0.1, f);
  EXPECT_NEAR(f.P(3, 3), 0.1 * 4 / 400, 1e-12);
  EXPECT_NEAR(f.P(1, 1), 0.001 / 3 * 4 + 0.01 * 0.1, 1e-12);
}

TEST(Wheeled, AnUncertainHeadingMovesByItsMoments) {
  // Against the moments of half a million drawn states moved exactly; bounds: five standard errors.
  ObjectClass c = wheeled();
  c.accel_psd = c.yaw_rate_psd = c.position_psd = 0;
  ClassFilter f = orientedFilter(3, -2, 7, 0.8);
  f.P(3, 3) = 0.16;
  f.P(2, 3) = f.P(3, 2) = 0.12;
  const ClassFilter before = f;
  constexpr double kDt = 0.1;
  predictClassFilter(c, kDt, f);

  constexpr int kDraws = 500000;
  const Matrix4 root = before.P.llt().matrixL();
  Rng rng({5});
  Vector4 sum = Vector4::Zero();
  Matrix4 squares = Matrix4::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Vector4 n(rng.normal(), rng.normal(), rng.normal(), rng.normal());
    Vector4 x = before.x + root * n;
    x.head<2>() += kDt * x[2] * Vector2(std::cos(x[3]), std::sin(x[3]));
    const Vector4 d = x - f.x;
    sum += d;
    squares += d * d.transpose();
  }
  const Vector4 mean = sum / kDraws;
  const Matrix4 covariance = squares / kDraws - mean * mean.transpose();
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(mean[i], 0, 5 * std::sqrt(f.P(i, i) / kDraws)) << i;
    for (int j = 0; j < 4; ++j)
      EXPECT_NEAR(covariance(i, j), f.P(i, j), 5 * std::sqrt(2 * f.P(i, i) * f.P(j, j) / kDraws))
          << i << j;
  }
  // The tangent would say: seven tenths of a meter ahead; the mean of the turns is shorter.
  EXPECT_LT((f.x - before.x).head<2>().norm(), 0.7 * std::exp(-0.08) + 0.02);
}

TEST(Wheeled, MomentsJoinTheTangentWhereHeadingsAreSure) {
  const ObjectClass c = wheeled();
  ClassFilter tangent = orientedFilter(3, -2, 7, 0.8), moments = tangent;
  tangent.P(3, 3) = std::pow(radians(4.99), 2);
  moments.P(3, 3) = std::pow(radians(5.01), 2);
  predictClassFilter(c, 0.1, tangent);
  predictClassFilter(c, 0.1, moments);
  EXPECT_LT((tangent.x - moments.x).norm(), 0.003);  // 0.4 % of 0.7 m
  EXPECT_LT((tangent.P - moments.P).norm(), 0.005);
}

TEST(Wheeled, NoiseIsTheIntegralOfItsLinearization) {
  // Van Loan by fine steps of the linear system at fixed v, theta: d/dt Q = A Q + Q A' + G.
  const double v = 8, theta = 0.7, dt = 0.2;
  const ObjectClass c = wheeled();
  Matrix4 A = Matrix4::Zero();
  A(0, 2) = std::cos(theta);
  A(1, 2) = std::sin(theta);
  A(0, 3) = -v * std::sin(theta);
  A(1, 3) = v * std::cos(theta);
  Matrix4 G = Matrix4::Zero();
  G.diagonal() << c.position_psd, c.position_psd, c.accel_psd, c.yaw_rate_psd;
  Matrix4 Q = Matrix4::Zero();
  const int steps = 200000;
  const double h = dt / steps;
  for (int i = 0; i < steps; ++i) Q += h * (A * Q + Q * A.transpose() + G);
  ClassFilter f;
  f.x << 0, 0, v, theta;
  f.oriented = true;
  predictClassFilter(c, dt, f);
  EXPECT_LT((f.P - Q).cwiseAbs().maxCoeff(), 1e-5 * Q.cwiseAbs().maxCoeff());
}

TEST(Wheeled, DrivesAlongItsHeading) {
  ClassFilter f = orientedFilter(1, 1, 10, radians(30));
  f.P *= 1e-6;
  predictClassFilter(wheeled(), 0.1, f);
  EXPECT_NEAR(f.x[0], 1 + std::cos(radians(30)), 1e-12);
  EXPECT_NEAR(f.x[1], 1 + 0.5, 1e-12);
}

TEST(Wheeled, KeepsTheWayThatItHasSurelyTraveled) {
  ClassFilter f = orientedFilter(3, -2, 4, 2.8);
  for (int i = 0; i < 20; ++i) predictClassFilter(wheeled(), 0.1, f);
  EXPECT_NEAR(f.heading.traveled, 8, 1e-9);
  reverse(f);
  EXPECT_NEAR(f.heading.traveled, -8, 1e-9);
  ClassFilter standing = orientedFilter(3, -2, 0.5, 2.8);
  for (int i = 0; i < 20; ++i) predictClassFilter(wheeled(), 0.1, standing);
  EXPECT_EQ(standing.heading.traveled, 0);
}

TEST(Wheeled, AWayThatDetectionsDoNotConfirmIsNone) {
  ClassFilter f = orientedFilter(3, -2, 4, 2.8);
  const Vector2 seen = f.x.head<2>();
  for (int i = 0; i < 20; ++i) {
    f.P.setZero();  // an uncertain heading moves by its moments, a little less than v dt
    predictClassFilter(wheeled(), 0.1, f);
    const Vector2 predicted = f.x.head<2>();
    f.x.head<2>() = seen;
    correctWay(predicted, f);
  }
  EXPECT_NEAR(f.heading.traveled, 0, 1e-9);
}

TEST(Wheeled, ReversalIsAnExactSymmetry) {
  ClassFilter forward = orientedFilter(3, -2, 4, 2.8);
  ClassFilter backward = forward;
  reverse(backward);
  const auto kf = kinematicsOf(wheeled(), forward), kb = kinematicsOf(wheeled(), backward);
  EXPECT_LT((kf.q.head<4>() - kb.q.head<4>()).norm(), 1e-12);
  predictClassFilter(wheeled(), 0.15, forward);
  predictClassFilter(wheeled(), 0.15, backward);
  reverse(backward);
  EXPECT_LT((forward.x.head<3>() - backward.x.head<3>()).norm(), 1e-12);
  EXPECT_NEAR(wrapAngle(forward.x[3] - backward.x[3]), 0, 1e-12);
  EXPECT_LT((forward.P - backward.P).norm(), 1e-12);
}

TEST(Wheeled, OrientingByVelocityKeepsWhatIsKnown) {
  ClassFilter f;
  f.x << 5, 6, 3, 4;
  f.P.diagonal() << 0.1, 0.1, 0.2, 0.2;
  f.P(0, 2) = f.P(2, 0) = 0.05;
  ClassFilter g = f;
  orientByVelocity(g);
  EXPECT_TRUE(g.oriented);
  EXPECT_NEAR(g.x[2], 5, 1e-12);
  EXPECT_NEAR(g.x[3], std::atan2(4, 3), 1e-12);
  // Back through the kinematics' Jacobian: the same velocity covariance.
  const auto k = kinematicsOf(wheeled(), g);
  const Matrix4 back = (k.J.topRows<4>() * g.P * k.J.topRows<4>().transpose());
  EXPECT_LT((back - f.P).norm(), 1e-12);
}

TEST(Wheeled, OrientingByAxisPointsWhereItMoves) {
  ClassFilter f;
  f.x << 0, 0, -2, 0.1;
  f.P = 0.3 * Matrix4::Identity();
  orientByAxis(0.05, 0.01, f);
  EXPECT_NEAR(std::abs(wrapAngle(f.x[3] - (0.05 + kPi))), 0, 1e-12);
  EXPECT_GT(f.x[2], 0);
}

TEST(MotionModels, KinematicsJacobianIsTheDerivative) {
  Rng rng({3, 0, 0, 0});
  for (int trial = 0; trial < 1000; ++trial) {
    ClassFilter f =
        orientedFilter(rng.normal(0, 10), rng.normal(0, 10), rng.normal(0, 8), rng.uniform(-3, 3));
    const auto k = kinematicsOf(wheeled(), f);
    for (int i = 0; i < 4; ++i) {
      const double h = 1e-6;
      ClassFilter up = f, down = f;
      up.x[i] += h;
      down.x[i] -= h;
      const Vector5 numeric =
          (kinematicsOf(wheeled(), up).q - kinematicsOf(wheeled(), down).q) / (2 * h);
      ASSERT_LT((numeric - k.J.col(i)).norm(), 1e-6);
    }
  }
}

TEST(MotionModels, CovariancesStayPositiveOverTenThousandSteps) {
  Rng rng({4, 0, 0, 0});
  for (const auto& c : {wheeled(), test::linearClasses()[0], test::linearClasses()[1]}) {
    ClassFilter f = orientedFilter(0, 0, 3, 1);
    if (!c.motion->has_heading) f.oriented = false;
    if (!c.motion->moves) f.P.bottomRightCorner<2, 4>().setZero(), f.P.rightCols<2>().setZero();
    for (int i = 0; i < 10000; ++i) {
      predictClassFilter(c, rng.uniform(0.01, 0.4), f);
      // A position fix, so that the covariance does not just grow.
      const Eigen::Matrix<double, 4, 2> K =
          f.P.leftCols<2>() * (f.P.topLeftCorner<2, 2>() + 0.04 * Matrix2::Identity()).inverse();
      f.x += K * Vector2(rng.normal(0, 0.2), rng.normal(0, 0.2));
      f.P -= (K * f.P.topRows<2>()).eval();
      f.P = (0.5 * (f.P + f.P.transpose())).eval();
      const double smallest = Eigen::SelfAdjointEigenSolver<Matrix4>(f.P).eigenvalues().minCoeff();
      ASSERT_GE(smallest, -1e-9) << c.name << " at step " << i;
    }
  }
}

ObjectClass walkerWithModes() {
  ObjectClass c = test::linearClasses()[0];
  c.mode_accel_psd = {0.04, 1.0};
  c.mode_damping = {0, 2.0};
  c.mode_sojourn = {4, 1.5};
  return c;
}

ClassFilter startedFilter(const ObjectClass& c) {
  ClassFilter f;
  f.x << 1, 2, 0.5, -0.3;
  f.P = 0.1 * Matrix4::Identity();
  startModes(c, f);
  return f;
}

TEST(Modes, StartAtTheirSharesOfTime) {
  const auto f = startedFilter(walkerWithModes());
  ASSERT_EQ(f.modes.size(), 2u);
  EXPECT_NEAR(std::exp(f.modes[0].log_probability), 4 / 5.5, 1e-12);
  EXPECT_NEAR(std::exp(f.modes[1].log_probability), 1.5 / 5.5, 1e-12);
}

TEST(Modes, KeepTheirSharesWhileNothingIsSeen) {
  // Stationary shares are proportional to the sojourns when two modes alternate.
  const auto c = walkerWithModes();
  auto f = startedFilter(c);
  for (int i = 0; i < 50; ++i) predictClassFilter(c, 0.1, f);
  // The chain in steps of dt stays for dt / (1 - exp(-dt / tau)) on average.
  const double a = 1 - std::exp(-0.1 / 4), b = 1 - std::exp(-0.1 / 1.5);
  EXPECT_NEAR(std::exp(f.modes[0].log_probability), b / (a + b), 1e-3);
}

TEST(Modes, OfEqualNoiseAreOneModel) {
  ObjectClass c = walkerWithModes();
  c.mode_accel_psd = {c.accel_psd, c.accel_psd};
  c.mode_damping = {0, 0};
  auto f = startedFilter(c);
  ClassFilter single;
  single.x = f.x;
  single.P = f.P;
  for (int i = 0; i < 10; ++i) {
    predictClassFilter(c, 0.13, f);
    predictClassFilter(test::linearClasses()[0], 0.13, single);
  }
  EXPECT_LT((f.x - single.x).norm(), 1e-12);
  EXPECT_LT((f.P - single.P).norm(), 1e-12);
}

TEST(Modes, DampingIsTheSolutionOfItsEquation) {
  // dv = -a v dt + noise: small steps of Euler's method against the closed form.
  ObjectClass c = walkerWithModes();
  c.mode_accel_psd = {0.7, 0.7};
  c.mode_damping = {1.3, 1.3};
  auto f = startedFilter(c);
  Vector4 x = f.x;
  Matrix4 P = f.P;
  const double dt = 0.4, a = 1.3, q = 0.7;
  const int steps = 40000;
  Matrix4 A = Matrix4::Zero(), G = Matrix4::Zero();
  A(0, 2) = A(1, 3) = 1;
  A(2, 2) = A(3, 3) = -a;
  G(2, 2) = G(3, 3) = q;
  for (int i = 0; i < steps; ++i) {
    const double h = dt / steps;
    x += h * A * x;
    P += h * (A * P + P * A.transpose() + G);
  }
  predictClassFilter(c, dt, f);
  EXPECT_LT((f.x - x).norm(), 1e-4);
  EXPECT_LT((f.P - P).norm(), 1e-4);
}

TEST(Modes, OfOrientedFiltersMeetAcrossTheWrapOfAngles) {
  ObjectClass c = wheeled();
  c.mode_accel_psd = {1, 3};
  c.mode_damping = {0, 0};
  c.mode_sojourn = {1, 1};
  ClassFilter f = orientedFilter(0, 0, 5, kPi - 0.01);
  startModes(c, f);
  f.modes[1].x[3] = -kPi + 0.03;
  combineModes(f);
  EXPECT_NEAR(std::abs(wrapAngle(f.x[3] - (kPi + 0.01))), 0, 1e-12);
  EXPECT_LT(f.P(3, 3), 0.05);
}

TEST(Modes, AreReversedWithTheirFilter) {
  ObjectClass c = wheeled();
  c.mode_accel_psd = {1, 3};
  c.mode_damping = {0, 0};
  c.mode_sojourn = {1, 1};
  ClassFilter f = orientedFilter(0, 0, -5, 0.4);
  startModes(c, f);
  reverse(f);
  ClassFilter g = f;
  combineModes(g);
  EXPECT_LT((f.x - g.x).norm(), 1e-12);
  EXPECT_LT((f.P - g.P).norm(), 1e-12);
}

}  // namespace
}  // namespace perception
