#include "libperception/filter/likelihood/Linearization.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Random.h"
#include "libperception/filter/state/ClassFilterMotion.h"
#include "libperception/measurement/models/FootprintModel.h"
#include "libperception/measurement/models/PositionModel.h"

namespace perception {
namespace {

ObjectClass bus() {
  ObjectClass c;
  c.name = "bus";
  c.motion = findMotionModel("wheeled");
  c.length = 11, c.width = 2.5;
  return c;
}

FootprintModel outlines() {
  ClassTable classes;
  classes.classes = {bus()};
  std::vector<ClassDetection> rows(1);
  rows[0].labels = {{"thing", 1.0}};
  return {classes, DetectionModel(DetectionParams{}, rows, {"thing"})};
}

/// A bus 20 m ahead that nearly shows its side.
ClassFilter broadside(double yaw_sigma) {
  ClassFilter f;
  f.x << 20, 3, 5, 1.5;
  f.P.diagonal() << 0.1, 0.1, 0.3, yaw_sigma * yaw_sigma;
  f.extent = {11, 2.5, 0, 0};
  f.oriented = true;
  return f;
}

AxisPrediction plain(const ClassFilter& f, const MeasurementModel& model) {
  const Kinematics k = kinematicsOf(bus(), f);
  AxisPrediction p;
  model.predict(&k, &f.extent, 1, {}, &p);
  return p;
}

AxisPrediction linearized(const ClassFilter& f, const MeasurementModel& model) {
  AxisPrediction p = plain(f, model);
  linearizeAlongAspect(bus(), f, kinematicsOf(bus(), f), model, {}, p);
  return p;
}

TEST(Linearization, LeavesASureHeadingToItsTangent) {
  const FootprintModel model = outlines();
  const ClassFilter f = broadside(0.001);
  const AxisPrediction p = linearized(f, model), tangent = plain(f, model);
  // The place's part in the aspect alone: 3 mm of a corner.
  EXPECT_LT((p.h - tangent.h).norm(), 0.01);
}

TEST(Linearization, LeavesModelsThatSeeNoAspectAlone) {
  PositionModel::Params params;
  params.classes.resize(1);
  params.classes[0].labels = {1};
  params.clutter_labels = {1};
  const PositionModel model(params);
  const ClassFilter f = broadside(0.4);
  EXPECT_EQ(linearized(f, model).h, plain(f, model).h);
  EXPECT_EQ(linearized(f, model).H_q, plain(f, model).H_q);
}

TEST(Linearization, TellsMeanAndSpreadBetterThanTheTangent) {
  // Near broadside the nearest point slides from one end of the side to the other.
  const FootprintModel model = outlines();
  const ClassFilter f = broadside(0.3);
  const AxisPrediction p = linearized(f, model), tangent = plain(f, model);
  const Kinematics k = kinematicsOf(bus(), f);
  const auto spread = [&](const AxisPrediction& a) {
    const Eigen::MatrixXd H = a.H_q * k.J;
    Eigen::MatrixXd S = H * f.P * H.transpose();
    if (a.R_model.size() > 0) S += a.R_model;
    return S;
  };
  const Matrix4 root = f.P.llt().matrixL();
  Rng rng({7});
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    ClassFilter drawn = f;
    drawn.x += root * Vector4(rng.normal(), rng.normal(), rng.normal(), rng.normal());
    const Eigen::Vector3d h = plain(drawn, model).h;
    sum += h;
    squares += h * h.transpose();
  }
  const Eigen::Vector3d mean = sum / kDraws;
  const Eigen::Matrix3d truth = squares / kDraws - mean * mean.transpose();
  const int range = FootprintModel::kRange;
  EXPECT_LT((p.h - mean).norm(), 0.5 * (tangent.h - mean).norm());
  // The wide points are on the safe side: no less than the truth, no more than twice.
  EXPECT_GT(spread(p)(range, range), 0.9 * truth(range, range));
  EXPECT_LT(spread(p)(range, range), 2.0 * truth(range, range));
  EXPECT_LT(std::abs(spread(p)(range, range) - truth(range, range)),
            0.7 * std::abs(spread(tangent)(range, range) - truth(range, range)));
}

TEST(Linearization, AddsNoNegativeVariance) {
  const FootprintModel model = outlines();
  Rng rng({9});
  for (int i = 0; i < 500; ++i) {
    ClassFilter f = broadside(rng.uniform(0.02, 0.8));
    f.x << rng.uniform(-30, 30), rng.uniform(8, 30), rng.uniform(-5, 15), rng.uniform(-kPi, kPi);
    const AxisPrediction p = linearized(f, model);
    if (p.R_model.size() == 0) continue;
    const Eigen::MatrixXd R = p.R_model;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(R);
    EXPECT_GE(eigen.eigenvalues().minCoeff(), -1e-9);
  }
}

}  // namespace
}  // namespace perception
