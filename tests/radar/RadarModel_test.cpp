#include "libperception/radar/RadarModel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/math/LogMath.h"
#include "libperception/core/math/Random.h"

namespace perception {
namespace {

ClassTable classes() {
  ObjectClass car;
  car.name = "car";
  car.motion = findMotionModel("wheeled");
  car.length = 4.5, car.width = 1.8, car.length_sigma = 0.6, car.width_sigma = 0.2;
  car.max_speed = 40;
  ObjectClass post;
  post.name = "static-other";
  post.motion = findMotionModel("static");
  return {{car, post}};
}

RadarModel model(RadarModelParams params = {}) {
  DetectionParams p;
  p.modality = Modality::kRadar;
  p.clutter_per_scan = 0.3;
  p.births_per_scan = 0.05;
  p.range_max = 100;
  p.fov = radians(60);
  return RadarModel(classes(), DetectionModel(p, {{}, {}}, {"target"}), params);
}

/// A unit at the front left corner of a vehicle that drives and turns.
SensorState drivingSensor() {
  SensorState s;
  s.ego.T_world_ego = makePose(10, -5, 0, 0.6);
  s.ego.velocity = rotate2(0.6, {12, 0});
  s.ego.yaw_rate = 0.3;
  s.T_world_sensor = s.ego.T_world_ego * makePose(3.5, 0.8, 0.5, 0.5);
  return s;
}

AxisPrediction predict(const Kinematics& k, const Extent& e, const SensorState& s,
                       RadarModelParams params = {}) {
  AxisPrediction out;
  model(params).predict(&k, &e, 1, s, &out);
  return out;
}

Measurement returnOf(double range, double bearing, double rate) {
  Measurement m;
  m.z = Vector3(range, bearing, rate);
  m.R = Vector3(0.25, 0.001, 0.02).asDiagonal();
  m.seen = RadarModel::kAll;
  return m;
}

TEST(RadarModel, SensorVelocityHasTheLeverArmsShare) {
  SensorState s;
  s.ego.velocity = {10, 1};
  s.ego.yaw_rate = 0.5;
  s.T_world_sensor = makePose(3, 0.8, 0, 0);
  const Vector2 v = sensorVelocity(s);  // method.md 4.3: (vx - sy w, vy + sx w)
  EXPECT_NEAR(v.x(), 10 - 0.8 * 0.5, 1e-12);
  EXPECT_NEAR(v.y(), 1 + 3 * 0.5, 1e-12);
}

TEST(RadarModel, RangeRateOfAPointIsTheDerivativeOfItsRangeInTime) {
  Rng rng({3, 0, 0, 0});
  const Extent point{0.02, 0.02, 0, 0};
  for (int trial = 0; trial < 200; ++trial) {
    SensorState s = drivingSensor();
    Kinematics k;
    k.q << rng.uniform(30, 60), rng.uniform(-30, 30), rng.uniform(-20, 20), rng.uniform(-20, 20), 0;
    const double rate = predict(k, point, s).h[RadarModel::kRate];
    const double dt = 1e-5;
    const double before = predict(k, point, s).h[RadarModel::kRange];
    const Pose3 mount = s.ego.T_world_ego.inverse() * s.T_world_sensor;
    Pose3& ego = s.ego.T_world_ego;
    ego = makePose(ego.translation().x() + dt * s.ego.velocity.x(),
                   ego.translation().y() + dt * s.ego.velocity.y(), 0,
                   yawOf(ego) + dt * s.ego.yaw_rate);
    s.T_world_sensor = ego * mount;
    k.q.head<2>() += dt * k.q.segment<2>(2);
    EXPECT_NEAR((predict(k, point, s).h[RadarModel::kRange] - before) / dt, rate, 1e-3);
  }
}

TEST(RadarModel, JacobiansAreTheDerivatives) {
  Rng rng({4, 0, 0, 0});
  const SensorState s = drivingSensor();
  int same = 0, total = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    Kinematics k;
    k.q << rng.uniform(-40, 60), rng.uniform(-40, 40), rng.uniform(-20, 20), rng.uniform(-20, 20),
        rng.uniform(-3, 3);
    k.has_yaw = trial % 2 == 0;
    const Extent e{rng.uniform(0.5, 6), rng.uniform(0.4, 2.5), 1, 1};
    const auto p = predict(k, e, s);
    if (!p.defined || p.h[RadarModel::kRange] < 2) continue;
    const double h = 1e-6;
    const auto difference = [&](Kinematics up, Extent eu, Kinematics down, Extent ed) {
      const auto a = predict(up, eu, s), b = predict(down, ed, s);
      return Vector3((a.h[0] - b.h[0]) / (2 * h), wrapAngle(a.h[1] - b.h[1]) / (2 * h),
                     (a.h[2] - b.h[2]) / (2 * h));
    };
    for (int column = 0; column < 5; ++column, ++total) {
      Kinematics up = k, down = k;
      up.q[column] += h, down.q[column] -= h;
      // Where the extreme corner changes a difference quotient says nothing: one in thousands.
      same += (difference(up, e, down, e) - Vector3(p.H_q.col(column))).norm() < 1e-4;
    }
    Extent longer = e, shorter = e, wider = e, narrower = e;
    longer.length += h, shorter.length -= h, wider.width += h, narrower.width -= h;
    same += (difference(k, longer, k, shorter) - Vector3(p.H_extent.col(0))).norm() < 1e-4;
    same += (difference(k, wider, k, narrower) - Vector3(p.H_extent.col(1))).norm() < 1e-4;
    total += 2;
  }
  EXPECT_GT(total, 15000);
  EXPECT_GE(same, total - total / 1000);
}

TEST(RadarModel, PointJacobianIsThePrintedOne) {
  // method.md 4.3: beta (-dy, dx)/rho^2; rho u; rho_dot (V - v_s - u rho_dot)/rho and u.
  const SensorState s = drivingSensor();
  Kinematics k;
  k.q << 40, 12, -7, 3, 0;
  const auto p = predict(k, {1e-4, 1e-4, 0, 0}, s);
  const Vector2 d = k.q.head<2>() - s.T_world_sensor.translation().head<2>();
  const double rho = d.norm();
  const Vector2 u = d / rho, relative = k.q.segment<2>(2) - sensorVelocity(s);
  const double rate = u.dot(relative);
  EXPECT_NEAR(p.h[RadarModel::kRate], rate, 1e-6);
  const auto row = [&](int axis, int column) { return p.H_q(axis, column); };
  const Vector2 dp = (relative - u * rate) / rho;
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(row(RadarModel::kRange, i), u[i], 1e-6);
    EXPECT_NEAR(row(RadarModel::kBearing, i), Vector2(-d.y(), d.x())[i] / (rho * rho), 1e-6);
    EXPECT_NEAR(row(RadarModel::kRate, i), dp[i], 1e-5);
    EXPECT_NEAR(row(RadarModel::kRate, 2 + i), u[i], 1e-6);
  }
}

TEST(RadarModel, SpreadOfReflectingPointsHasTheModelsCovariance) {
  // Points anywhere on the width that the unit sees, moving with the object: their bearings and
  // rates scatter together as R_model says.
  const SensorState s = drivingSensor();
  Kinematics k;
  k.q << 34, 20, 9, -4, 1.0;
  k.has_yaw = true;
  const Extent e{4.5, 1.8, 0, 0};
  const auto p = predict(k, e, s);
  FootprintModel outline(classes(), DetectionModel({}, {{}, {}}, {"target"}));
  AxisPrediction edges;
  outline.predict(&k, &e, 1, s, &edges);
  Rng rng({5, 0, 0, 0});
  const int n = 20000;
  Matrix2 scatter = Matrix2::Zero();
  const double forward = yawOf(s.T_world_sensor);
  for (int i = 0; i < n; ++i) {
    const double bearing = rng.uniform(edges.h[1], edges.h[0]);
    const Vector2 u(std::cos(forward + bearing), std::sin(forward + bearing));
    const double rate = u.dot(k.q.segment<2>(2) - sensorVelocity(s));
    const Vector2 off(bearing - p.h[RadarModel::kBearing], rate - p.h[RadarModel::kRate]);
    scatter += off * off.transpose() / n;
  }
  const Matrix2 expected = p.R_model.bottomRightCorner<2, 2>();
  // Standard deviation of the mean of squares of a uniform variable: .9 / sqrt(n) of it.
  EXPECT_LT((scatter - expected).norm(), (5 * 0.9 / std::sqrt(n) + 0.01) * expected.norm());
}

TEST(RadarModel, CenterOfUnknownHeadingLiesHalfItsMeanDepthBehindTheReturn) {
  // Cars of all headings (simulated), far away: what their nearest points say of their centers.
  SensorState s;
  Kinematics k;
  k.q << 60, 0, 0, 0, 0;
  const Extent e{4.5, 1.8, 0, 0};
  const double unknown = predict(k, e, s).h[RadarModel::kRange];
  Rng rng({6, 0, 0, 0});
  const int n = 20000;
  double sum = 0, square = 0;
  k.has_yaw = true;
  for (int i = 0; i < n; ++i) {
    k.q[4] = rng.uniform(-kPi, kPi);
    const double off = predict(k, e, s).h[RadarModel::kRange] - unknown;
    sum += off, square += off * off;
  }
  EXPECT_LT(std::abs(sum / n), 0.05);  // nearest points off the line of sight are a little farther
  k.has_yaw = false;
  const auto p = predict(k, e, s);
  const double depth = 0.15 * 2 * 0.25 * (e.length + e.width);  // RadarModelParams::depth_share
  EXPECT_NEAR(square / n, p.R_model(0, 0) - depth * depth, 0.05);
  const auto birth = model().birth(returnOf(60, 0, -9), 0, s);
  EXPECT_NEAR(birth->position.x(), 60 + (4.5 + 1.8) / kPi, 1e-9);
}

TEST(RadarModel, MostOfWhatIsNoObjectStands) {
  const SensorState s = drivingSensor();
  const Vector2 own = sensorVelocity(s);
  const double forward = yawOf(s.T_world_sensor);
  const double still = -Vector2(std::cos(forward), std::sin(forward)).dot(own);
  const double stands = model().logClutterDensity(returnOf(30, 0, still), s);
  const double moves = model().logClutterDensity(returnOf(30, 0, still + 8), s);
  EXPECT_NEAR(moves, std::log(0.2 * 0.3 * 30 / model().detection_model().area() / 53.6), 1e-6);
  EXPECT_GT(stands - moves, std::log(100));
}

TEST(RadarModel, OnlyMovingReturnsStartObjects) {
  const SensorState s = drivingSensor();
  const Vector2 own = sensorVelocity(s);
  const double forward = yawOf(s.T_world_sensor);
  for (const double bearing : {-0.4, 0.0, 0.3}) {
    const double still =
        -Vector2(std::cos(forward + bearing), std::sin(forward + bearing)).dot(own);
    RadarModelParams plain;
    plain.min_birth_sigmas = 0;
    EXPECT_EQ(model(plain).logBirthDensity(returnOf(30, bearing, still + 0.49), 0, s),
              kMinusInfinity);
    EXPECT_GT(model(plain).logBirthDensity(returnOf(30, bearing, still - 0.51), 0, s),
              kMinusInfinity);
    EXPECT_GT(model().logBirthDensity(returnOf(30, bearing, still + 5), 0, s), kMinusInfinity);
    // They are measurements of known objects all the same: the density of clutter is finite.
    EXPECT_GT(model().logClutterDensity(returnOf(30, bearing, still), s), kMinusInfinity);
  }
  // A unit that looks across the road turns a bad bearing into speed: 12 m/s * .1 rad.
  Measurement rough = returnOf(30, 1.0, 0);
  rough.R(1, 1) = 0.01;
  rough.z[2] = -Vector2(std::cos(forward + 1.0), std::sin(forward + 1.0)).dot(own) + 1.5;
  EXPECT_EQ(model().logBirthDensity(rough, 0, s), kMinusInfinity);
}

TEST(RadarModel, DensitiesIntegrateToTheRates) {
  SensorState s;  // parked: every return counts for births where min_birth_speed = 0
  RadarModelParams params;
  params.min_birth_speed = 0;
  const RadarModel m = model(params);
  double clutter = 0, births = 0, births_without_rate = 0;
  const double dr = 0.5, da = radians(0.5), dv = 0.1;
  for (double range = dr / 2; range < 100; range += dr) {
    for (double bearing = radians(-29.75); bearing < radians(30); bearing += da) {
      Measurement z = returnOf(range, bearing, 0);
      z.seen = RadarModel::kNoRate;
      births_without_rate += std::exp(m.logBirthDensity(z, 0, s)) * dr * da;
    }
  }
  for (double v = -26.8 + dv / 2; v < 26.8; v += dv) {
    clutter += std::exp(m.logClutterDensity(returnOf(50, 0, v), s)) * dv;
  }
  for (double v = -60 + dv / 2; v < 60; v += dv)
    births += std::exp(m.logBirthDensity(returnOf(50, 0, v), 0, s)) * dv;
  const double per_cell = 50 / m.detection_model().area();  // [1/m/rad] at 50 m
  EXPECT_NEAR(births_without_rate, 0.05, 1e-3 * 0.05);
  EXPECT_NEAR(clutter, 0.3 * per_cell, 1e-6 * per_cell);
  EXPECT_NEAR(births, 0.05 * per_cell, 2e-3 * 0.05 * per_cell);
}

TEST(RadarModel, ANewbornMovesAsItsRangeRateSays) {
  const SensorState s = drivingSensor();
  const Vector2 own = sensorVelocity(s);
  const double forward = yawOf(s.T_world_sensor);
  const Vector2 u(std::cos(forward), std::sin(forward));
  const auto birth = model().birth(returnOf(40, 0, -9 - u.dot(own)), 0, s);
  ASSERT_TRUE(birth && birth->radial_speed);
  EXPECT_NEAR(birth->radial_speed->along.mean, -9, 1e-9);
  EXPECT_FALSE(birth->radial_speed->across_sigma);
  EXPECT_FALSE(birth->yaw);
  EXPECT_FALSE(model().birth(returnOf(40, 0, -9), 1, s)->radial_speed);  // static-other
  RadarModelParams duc;
  duc.birth_heading_sigma = radians(30);
  const auto aligned = model(duc).birth(returnOf(40, 0, -9 - u.dot(own)), 0, s);
  EXPECT_NEAR(*aligned->radial_speed->across_sigma, 9 * std::tan(radians(30)), 1e-9);
}

TEST(RadarModel, WhatALidarFindsHiddenIsStillDetected) {
  const SensorState s = drivingSensor();
  Kinematics k;
  const double forward = yawOf(s.T_world_sensor);
  k.q.head<2>() =
      s.T_world_sensor.translation().head<2>() + 30 * Vector2(std::cos(forward), std::sin(forward));
  const Extent e{4.5, 1.8, 0, 0};
  const double open = model().detectionProbability(0, k, e, s, 1);
  EXPECT_GT(open, 0.5);
  EXPECT_NEAR(model().detectionProbability(0, k, e, s, 0), 0.5 * open, 1e-12);
}

}  // namespace
}  // namespace perception
