#include "libperception/measurement/models/FootprintInView.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Random.h"
#include "libperception/measurement/models/FootprintModel.h"

namespace perception {
namespace {

AxisPrediction predict(const Vector2& d, double yaw, const Extent& extent, double radius) {
  AxisPrediction out;
  predictRectangle(d, yaw, extent, radius, 0, out);
  return out;
}

/// Nearest point and extreme bearings, off that of the center, by a dense walk around the outline.
Vector3 walked(const Vector2& d, double yaw, const Extent& e, double radius) {
  const double middle = std::atan2(d.y(), d.x());
  Vector3 out(-10, 10, 1e9);
  const auto take = [&](const Vector2& own) {
    const Vector2 p = d + rotate2(yaw, own);
    const double off = wrapAngle(std::atan2(p.y(), p.x()) - middle);
    out = {std::max(out[0], off), std::min(out[1], off), std::min(out[2], p.norm())};
  };
  const Vector2 inner(e.length / 2 - radius, e.width / 2 - radius);
  for (int i = 0; i < 8000; ++i) {
    const double angle = kTwoPi * i / 8000;
    const Vector2 normal(std::cos(angle), std::sin(angle));
    take(Vector2(std::copysign(inner.x(), normal.x()), std::copysign(inner.y(), normal.y())) +
         radius * normal);
    const double t = i / 4000.0 - 1;  // the edges
    for (const double side : {-1.0, 1.0}) {
      take({t * inner.x(), side * e.width / 2});
      take({side * e.length / 2, t * inner.y()});
    }
  }
  return out;
}

TEST(FootprintInView, LinesOfSightTouchRoundedCorners) {
  Rng rng(RngKey{3, 0, 0, 0});
  for (int trial = 0; trial < 100; ++trial) {
    const double bearing = rng.uniform(-3, 3), range = rng.uniform(4, 40);
    const Vector2 d = range * Vector2(std::cos(bearing), std::sin(bearing));
    const double yaw = rng.uniform(-3, 3), radius = rng.uniform(0, 0.4);
    const Extent e{rng.uniform(2, 5), rng.uniform(1.6, 2.5), 1, 1};
    const auto p = predict(d, yaw, e, radius);
    ASSERT_TRUE(p.defined);
    const Vector3 wanted = walked(d, yaw, e, radius);
    EXPECT_NEAR(wrapAngle(p.h[FootprintModel::kLeft] - bearing), wanted[0], 1e-4);
    EXPECT_NEAR(wrapAngle(p.h[FootprintModel::kRight] - bearing), wanted[1], 1e-4);
    EXPECT_NEAR(p.h[FootprintModel::kRange], wanted[2], 1e-4);
  }
}

TEST(FootprintInView, AQuarterOfTheWidthIsTheLargestRadius) {
  const Extent narrow{1.8, 0.6, 1, 1};
  EXPECT_EQ(predict({10, 3}, 1, narrow, 0.4).h, predict({10, 3}, 1, narrow, 0.15).h);
}

TEST(FootprintInView, JacobiansOfRoundedOutlinesAreTheDerivatives) {
  Rng rng(RngKey{4, 0, 0, 0});
  int compared = 0, total = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Vector2 d(rng.uniform(-30, 30), rng.uniform(-30, 30));
    if (d.norm() < 4) continue;
    const double yaw = rng.uniform(-3, 3), radius = 0.3;
    const Extent e{rng.uniform(2, 5), rng.uniform(0.5, 2.5), 1, 1};  // some are narrow
    const auto p = predict(d, yaw, e, radius);
    const double h = 1e-6;
    const auto numeric = [&](double x, double y, double turn, double length,
                             double width) -> Vector3 {
      const auto at = [&](double step) {
        return predict({d.x() + step * x, d.y() + step * y}, yaw + step * turn,
                       {e.length + step * length, e.width + step * width, 1, 1}, radius)
            .h;
      };
      const auto up = at(h), down = at(-h);
      return Vector3(wrapAngle(up[0] - down[0]), wrapAngle(up[1] - down[1]), up[2] - down[2]) /
             (2 * h);
    };
    // At a kink (another corner is the extreme one) a difference quotient says nothing.
    const auto compare = [&](const Vector3& difference, const auto& column) {
      compared += (difference - Vector3(column)).norm() < 1e-5;
      ++total;
    };
    compare(numeric(1, 0, 0, 0, 0), p.H_q.col(0));
    compare(numeric(0, 1, 0, 0, 0), p.H_q.col(1));
    compare(numeric(0, 0, 1, 0, 0), p.H_q.col(4));
    compare(numeric(0, 0, 0, 1, 0), p.H_extent.col(0));
    compare(numeric(0, 0, 0, 0, 1), p.H_extent.col(1));
  }
  EXPECT_GT(total, 9000);
  EXPECT_GT(compared, 0.998 * total);
}

}  // namespace
}  // namespace perception
