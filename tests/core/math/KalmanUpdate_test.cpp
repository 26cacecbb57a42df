#include "libperception/core/math/KalmanUpdate.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <random>

namespace perception {
namespace {

using Vector4 = Eigen::Vector4d;
using Matrix4 = Eigen::Matrix4d;

template <int N>
Eigen::Matrix<double, N, N> drawCovariance(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Eigen::Matrix<double, N, N> A =
      Eigen::Matrix<double, N, N>::NullaryExpr([&] { return normal(random); });
  return A * A.transpose() + 0.1 * Eigen::Matrix<double, N, N>::Identity();
}

TEST(KalmanUpdate, IsThePosteriorInInformationForm) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 50; ++trial) {
    Vector4 x = Vector4::NullaryExpr([&] { return normal(random); });
    Matrix4 P = drawCovariance<4>(random);
    const Eigen::Matrix2d R = drawCovariance<2>(random);
    const Eigen::Matrix<double, 2, 4> H =
        Eigen::Matrix<double, 2, 4>::NullaryExpr([&] { return normal(random); });
    const Eigen::Vector2d y(normal(random), normal(random));
    const Eigen::Matrix2d S = H * P * H.transpose() + R;
    const Matrix4 P_after = (P.inverse() + H.transpose() * R.inverse() * H).inverse();
    const Vector4 x_after = x + P_after * H.transpose() * R.inverse() * y;
    const double log_density = josephUpdate<2, 4>(y, H, R, S, x, P);
    EXPECT_LT((x - x_after).norm(), 1e-9);
    EXPECT_LT((P - P_after).norm(), 1e-9);
    EXPECT_NEAR(log_density, -0.5 * (y.dot(S.inverse() * y) + std::log(S.determinant())), 1e-9);
  }
}

TEST(KalmanUpdate, OfAScalarIsThatOfOneAxis) {
  std::mt19937 random(4);
  Vector4 x(1, 2, 3, 4);
  Matrix4 P = drawCovariance<4>(random);
  ScalarEstimate third{x[2], P(2, 2)};
  josephUpdate<4>(0.7, 0.3, Eigen::RowVector4d(0, 0, 1, 0), x, P);
  scalarUpdate({third.mean + 0.7, 0.3}, third);
  EXPECT_NEAR(x[2], third.mean, 1e-12);
  EXPECT_NEAR(P(2, 2), third.variance, 1e-12);
}

TEST(KalmanUpdate, LeavesTheStateAloneWhereSIsNoCovariance) {
  Vector4 x(1, 2, 3, 4);
  Matrix4 P = Matrix4::Identity();
  const Eigen::RowVector4d h(1, 0, 0, 0);
  EXPECT_EQ(josephUpdate<4>(1, -2, h, x, P), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(x, Vector4(1, 2, 3, 4));
  EXPECT_EQ(P, Matrix4::Identity());
}

TEST(ScalarUpdate, StopsAtTheFloorAndNeverRaisesAVariance) {
  ScalarEstimate x{0, 1};
  for (int i = 0; i < 1000; ++i) scalarUpdate({2, 1}, x, 0.05);
  EXPECT_NEAR(x.mean, 2, 1e-3);
  EXPECT_EQ(x.variance, 0.05);
  ScalarEstimate known{0, 0.01};
  scalarUpdate({2, 1}, known, 0.05);
  EXPECT_EQ(known.variance, 0.01);
}

}  // namespace
}  // namespace perception
