#include "libperception/filter/likelihood/PairDensity.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "libperception/core/math/Random.h"
#include "libperception/filter/state/ClassFilterMotion.h"
#include "libperception/filter/state/FixedAxes.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

template <int N>
Eigen::Matrix<double, N, N> randomCovariance(Rng& rng) {
  Eigen::Matrix<double, N, N> root;
  for (int i = 0; i < N * N; ++i) root(i / N, i % N) = rng.normal();
  return root * root.transpose() + 0.1 * Eigen::Matrix<double, N, N>::Identity();
}

TEST(FixedFactors, SolveAndMeasureLikeTheInverse) {
  Rng rng({1, 2, 0, 0});
  for (int n = 1; n <= kMaxAxes; ++n) {
    withAxes(n, [&](auto size) {
      const auto S = randomCovariance<size>(rng);
      const Eigen::Matrix<double, size, 1> y = Eigen::Matrix<double, size, 1>::Constant(0.7);
      const FixedFactors<size> factors(S);
      ASSERT_TRUE(factors.positive());
      EXPECT_LT((factors.template solve<1>(y) - S.inverse() * y).norm(), 1e-9);
      EXPECT_NEAR(factors.normSquared(y), y.dot(S.inverse() * y), 1e-9);
      EXPECT_NEAR(factors.determinant() / S.determinant(), 1, 1e-9);
    });
  }
  EXPECT_FALSE(FixedFactors<2>(-Matrix2::Identity()).positive());
  EXPECT_FALSE(FixedFactors<2>(std::nan("") * Matrix2::Identity()).positive());
}

TEST(ExpectedAxes, GiveTheDensityOfTheInnovation) {
  const PositionModel model(test::linearSensor());
  const ClassTable classes = test::linearClasses();
  Rng rng({1, 3, 0, 0});
  for (int trial = 0; trial < 200; ++trial) {
    ClassFilter f;
    f.P = randomCovariance<4>(rng);
    const Kinematics k = kinematicsOf(classes[0], f);
    AxisPrediction h;
    model.predict(&k, &f.extent, 1, {}, &h);
    h.H_extent << 0.3, -0.2, 0.1, 0.4;
    Measurement m;
    m.z = Vector2(rng.normal(0, 2), rng.normal(0, 2));
    m.R = randomCovariance<2>(rng);
    m.seen = static_cast<AxisMask>(1 + trial % 3);
    ExpectedAxes expected;
    expected.set(f, k, h);
    const Density fast = expected.densityOf(h, m, AxisList(m, 2), model.axes());
    const Density whole = densityOf(innovationOf(f, k, h, m, model), f);
    ASSERT_NEAR(fast.log_density, whole.log_density, 1e-11) << trial;
    ASSERT_NEAR(fast.nis, whole.nis, 1e-9) << trial;
  }
}

}  // namespace
}  // namespace perception
