#include "libperception/lidar/outline/Outline.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

const std::vector<Vector2> kSquare = {{10, -1}, {12, -1}, {12, 1}, {10, 1}};

TEST(Outline, HasTheEdgesAndTheNearestPointOfASquareAhead) {
  const Outline outline = outlineOf(kSquare, makePose(0, 0, 2, 0));
  EXPECT_NEAR(outline.left, std::atan2(1, 10), 1e-12);
  EXPECT_NEAR(outline.right, -std::atan2(1, 10), 1e-12);
  EXPECT_NEAR(outline.nearest, 10, 1e-12);  // between two corners
  EXPECT_NEAR(outline.left_range, std::hypot(10, 1), 1e-12);
}

TEST(Outline, TurnsWithTheWorld) {
  const Pose3 sensor = makePose(0.5, 0.2, 2, 0.3);
  const Outline expected = outlineOf(kSquare, sensor);
  for (int k = 0; k < 12; ++k) {
    const Pose3 T = makePose(100, -50, 0, radians(30.0 * k));
    std::vector<Vector2> moved;
    for (const Vector2& p : kSquare) moved.push_back((T * Vector3(p.x(), p.y(), 0)).head<2>());
    const Outline outline = outlineOf(moved, T * sensor);
    EXPECT_NEAR(outline.left, expected.left, 1e-9);
    EXPECT_NEAR(outline.right, expected.right, 1e-9);
    EXPECT_NEAR(outline.nearest, expected.nearest, 1e-9);
  }
}

TEST(Outline, ReachesAcrossTheRearwardDirection) {
  const Outline outline = outlineOf({{-10, -1}, {-9, -1}, {-9, 1}, {-10, 1}}, Pose3::Identity());
  EXPECT_NEAR(outline.left, -kPi + std::atan2(1, 9), 1e-9);
  EXPECT_NEAR(outline.right, kPi - std::atan2(1, 9), 1e-9);
}

TEST(Outline, AnEdgeBesideSomethingNearerIsHidden) {
  const Pose3 sensor = Pose3::Identity();
  const double step = radians(0.4);
  OcclusionMap occlusion(Vector2::Zero(), 900);
  Outline outline = outlineOf(kSquare, sensor);
  const double beyond = outline.left + step;
  occlusion.add(5 * Vector2(std::cos(beyond), std::sin(beyond)));
  occlusion.add(30 * Vector2(std::cos(-beyond), std::sin(-beyond)));  // behind: hides nothing
  markHiddenEdges(outline, occlusion, sensor, 0.5, step, kTwoPi);
  EXPECT_TRUE(outline.left_hidden);
  EXPECT_FALSE(outline.right_hidden);
}

TEST(Outline, AnEdgeAtTheBorderOfTheViewIsHidden) {
  const OcclusionMap occlusion(Vector2::Zero(), 900);
  Outline outline = outlineOf(kSquare, Pose3::Identity());
  markHiddenEdges(outline, occlusion, Pose3::Identity(), 0.5, radians(0.4),
                  2 * (outline.left + radians(0.1)));
  EXPECT_TRUE(outline.left_hidden && outline.right_hidden);
}

TEST(Outline, AnEdgeBesideWhichTheScanHasNoReturnsIsHidden) {
  const double step = radians(0.4);
  Outline outline = outlineOf(kSquare, Pose3::Identity());
  const double turn = 1;  // of the sensor in the vehicle
  std::vector<std::uint8_t> any(900, 1);
  const auto first = static_cast<std::size_t>((turn + outline.left + step) / step);
  for (std::size_t k = first; k < first + 100; ++k) any[k] = 0;
  markEdgesOfField(outline, LidarField(any), turn, step);
  EXPECT_TRUE(outline.left_hidden);
  EXPECT_FALSE(outline.right_hidden);
}

TEST(Outline, CovarianceIsNoisePlusPoseByNumericDerivatives) {
  const PoseUncertainty pose;
  const Pose3 sensor = makePose(1, 2, 1.7, 0.4);
  const std::vector<Vector2> hull = {{9, 6}, {13, 5}, {14, 8}};
  const Outline outline = outlineOf(hull, sensor);
  Measurement m;
  fillFootprint(outline, 0.02, 0.03, 0.2, pose, yawOf(sensor), m);
  Eigen::Matrix3d J;
  const double e = 1e-6;
  for (int k = 0; k < 3; ++k) {
    const auto moved = [&](double by) {
      return outlineOf(hull,
                       makePose(1 + (k == 0) * by, 2 + (k == 1) * by, 1.7, 0.4 + (k == 2) * by));
    };
    const Outline high = moved(e), low = moved(-e);
    J.col(k) << (high.left - low.left) / (2 * e), (high.right - low.right) / (2 * e),
        (high.nearest - low.nearest) / (2 * e);
  }
  const Vector3 P(pose.sigma_xy * pose.sigma_xy, pose.sigma_xy * pose.sigma_xy,
                  pose.sigma_yaw * pose.sigma_yaw);
  Eigen::Matrix3d expected = J * P.asDiagonal() * J.transpose();
  expected.diagonal() += Vector3(0.02 * 0.02, 0.03 * 0.03, 0.2 * 0.2);
  EXPECT_LT((m.R - expected).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(m.seen, FootprintModel::kAll);
}

TEST(Outline, HiddenAxesHoldZeros) {
  Outline outline = outlineOf(kSquare, Pose3::Identity());
  outline.left_hidden = true;
  Measurement m;
  fillFootprint(outline, 0.02, 0.03, 0.2, {}, 0, m);
  EXPECT_EQ(m.seen, 1 << FootprintModel::kRight | 1 << FootprintModel::kRange);
  EXPECT_EQ(m.z[FootprintModel::kLeft], 0);
  EXPECT_EQ(m.R.row(FootprintModel::kLeft).cwiseAbs().sum(), 0);
  const Matrix2 rest = m.R.bottomRightCorner<2, 2>();
  EXPECT_GT(rest.determinant(), 0);
  EXPECT_GT(rest.trace(), 0);
}

}  // namespace
}  // namespace perception
