#include "libperception/measurement/models/FootprintModel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

ClassTable footprintClasses() {
  ObjectClass car;
  car.name = "car";
  car.motion = findMotionModel("wheeled");
  car.length = 4.5;
  car.width = 1.8;
  car.length_sigma = 0.6;
  car.width_sigma = 0.2;
  ObjectClass person;
  person.name = "pedestrian";
  person.motion = findMotionModel("constant-velocity");
  person.length = person.width = 0.5;
  person.length_sigma = person.width_sigma = 0.1;
  return {{car, person}};
}

FootprintModel model() {
  DetectionParams p;
  p.clutter_per_scan = 0.7;
  p.births_per_scan = 0.2;
  p.range_min = 1;
  p.range_max = 60;
  p.fov = radians(120);
  return FootprintModel(footprintClasses(),
                        DetectionModel(p, {{}, {}}, {"car_sized", "person_sized"}));
}

SensorState sensorAt(double x, double y, double yaw) {
  SensorState s;
  s.T_world_sensor = makePose(x, y, 1.7, yaw);
  return s;
}

Kinematics rectangle(double x, double y, double yaw) {
  Kinematics k;
  k.q << x, y, 0, 0, yaw;
  k.has_yaw = true;
  return k;
}

AxisPrediction predict(const Kinematics& k, const Extent& e, const SensorState& s) {
  AxisPrediction out;
  model().predict(&k, &e, 1, s, &out);
  return out;
}

TEST(FootprintModel, SeesTheNearestPointAndTheExtremeCornersOfARectangle) {
  Rng rng({1, 0, 0, 0});
  for (int trial = 0; trial < 300; ++trial) {
    const SensorState s = sensorAt(rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(-3, 3));
    const double bearing = rng.uniform(-3, 3), range = rng.uniform(4, 40);
    const Vector2 origin = s.T_world_sensor.translation().head<2>();
    const Kinematics k = rectangle(origin.x() + range * std::cos(bearing),
                                   origin.y() + range * std::sin(bearing), rng.uniform(-3, 3));
    const Extent e{rng.uniform(1, 5), rng.uniform(0.4, 2.5), 1, 1};
    const auto p = predict(k, e, s);
    ASSERT_TRUE(p.defined);
    double nearest = 1e9, left = -10, right = 10;
    const int n = 2000;  // dense walk around the outline
    for (int i = 0; i < 4 * n; ++i) {
      const double t = (i % n) / static_cast<double>(n) - 0.5;
      const Vector2 own = i / n == 0   ? Vector2(t * e.length, e.width / 2)
                          : i / n == 1 ? Vector2(t * e.length, -e.width / 2)
                          : i / n == 2 ? Vector2(e.length / 2, t * e.width)
                                       : Vector2(-e.length / 2, t * e.width);
      const Vector2 d = k.q.head<2>() + rotate2(k.q[4], own) - origin;
      nearest = std::min(nearest, d.norm());
      const double off = wrapAngle(std::atan2(d.y(), d.x()) - bearing);
      left = std::max(left, off);
      right = std::min(right, off);
    }
    const double forward = yawOf(s.T_world_sensor);
    EXPECT_NEAR(p.h[FootprintModel::kRange], nearest, 1e-3);
    EXPECT_NEAR(wrapAngle(p.h[FootprintModel::kLeft] + forward - bearing), left, 2e-3);
    EXPECT_NEAR(wrapAngle(p.h[FootprintModel::kRight] + forward - bearing), right, 2e-3);
  }
}

TEST(FootprintModel, JacobiansAreTheDerivatives) {
  Rng rng({2, 0, 0, 0});
  int compared = 0, total = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const SensorState s = sensorAt(1, -2, 0.4);
    Kinematics k = rectangle(rng.uniform(-30, 30), rng.uniform(-30, 30), rng.uniform(-3, 3));
    k.has_yaw = trial % 2 == 0;
    const Extent e{rng.uniform(1, 5), rng.uniform(0.4, 2.5), 1, 1};
    const auto p = predict(k, e, s);
    if (!p.defined || p.h[FootprintModel::kRange] < 2) continue;
    const double h = 1e-6;
    const auto numeric = [&](const auto& change) {
      Kinematics up = k, down = k;
      Extent eu = e, ed = e;
      change(up, eu, h);
      change(down, ed, -h);
      const auto a = predict(up, eu, s), b = predict(down, ed, s);
      return Vector3(wrapAngle(a.h[0] - b.h[0]) / (2 * h), wrapAngle(a.h[1] - b.h[1]) / (2 * h),
                     (a.h[2] - b.h[2]) / (2 * h));
    };
    for (const int column : {0, 1, 4}) {
      const Vector3 d = numeric([&](Kinematics& q, Extent&, double step) { q.q[column] += step; });
      // At a kink (the extreme corner changes) a difference quotient says nothing: those are one in
      // thousands.
      if ((d - Vector3(p.H_q.col(column))).norm() < 1e-5) ++compared;
    }
    const Vector3 dl = numeric([&](Kinematics&, Extent& x, double step) { x.length += step; });
    const Vector3 dw = numeric([&](Kinematics&, Extent& x, double step) { x.width += step; });
    compared += (dl - Vector3(p.H_extent.col(0))).norm() < 1e-5;
    compared += (dw - Vector3(p.H_extent.col(1))).norm() < 1e-5;
    total += 5;
  }
  EXPECT_GT(total, 20000);
  EXPECT_GT(compared, 0.998 * total);
}

TEST(FootprintModel, NoiseOfAClassWidensItsEdgesByItsDistance) {
  ClassDetection rider;
  rider.edge_noise = 0.8;
  const FootprintModel noisy(footprintClasses(),
                             DetectionModel({}, {{}, rider}, {"car_sized", "person_sized"}));
  const SensorState sensor = sensorAt(0, 0, 0);
  AxisPrediction prediction;
  prediction.defined = true;
  noisy.addClassNoise(0, rectangle(20, 0, 0), sensor, prediction);
  EXPECT_EQ(prediction.R_model.size(), 0);  // the other class
  noisy.addClassNoise(1, rectangle(16, 12, 0), sensor, prediction);
  ASSERT_EQ(prediction.R_model.rows(), 3);
  EXPECT_NEAR(prediction.R_model(FootprintModel::kLeft, FootprintModel::kLeft), 0.0016, 1e-12);
  EXPECT_NEAR(prediction.R_model(FootprintModel::kRight, FootprintModel::kRight), 0.0016, 1e-12);
  EXPECT_EQ(prediction.R_model(FootprintModel::kRange, FootprintModel::kRange), 0);
  noisy.addClassNoise(1, rectangle(16, 12, 0), sensor, prediction);  // adds to what is there
  EXPECT_NEAR(prediction.R_model(FootprintModel::kLeft, FootprintModel::kLeft), 0.0032, 1e-12);
}

TEST(FootprintModel, OnlyRelativePlacesCount) {
  const Extent e{4.5, 1.8, 1, 1};
  const auto a = predict(rectangle(10, 3, 0.5), e, sensorAt(0, 0, 0.2));
  const double turn = 1.1;
  const Vector2 moved = rotate2(turn, {10, 3}) + Vector2(7, -4);
  const auto b =
      predict(rectangle(moved.x(), moved.y(), 0.5 + turn), e, sensorAt(7, -4, 0.2 + turn));
  EXPECT_LT((a.h - b.h).norm(), 1e-12);
}

TEST(FootprintModel, SaysNothingFromInsideAnObject) {
  EXPECT_FALSE(predict(rectangle(0.5, 0, 0), {4.5, 1.8, 1, 1}, sensorAt(0, 0, 0)).defined);
  Kinematics disc = rectangle(0.1, 0, 0);
  disc.has_yaw = false;
  EXPECT_FALSE(predict(disc, {0.5, 0.5, 1, 1}, sensorAt(0, 0, 0)).defined);
}

Measurement measurementOf(double left, double right, double range, AxisMask seen) {
  Measurement m;
  m.z = Vector3(left, right, range);
  m.R = AxisMatrix::Zero(3, 3);
  m.R.diagonal() << 1e-4, 1e-4, 0.04;
  m.seen = seen;
  m.position = range * Vector2(std::cos(0.5 * (left + right)), std::sin(0.5 * (left + right)));
  return m;
}

TEST(FootprintModel, ClutterDensityIntegratesToItsRate) {
  const FootprintModel f = model();
  const SensorState s = sensorAt(0, 0, 0);
  const double fov = radians(120);
  const int n = 400;
  double all = 0, one_edge = 0, range_only = 0;
  for (int i = 0; i < n; ++i) {
    const double range = 1 + 59 * (i + 0.5) / n, dr = 59.0 / n;
    range_only += std::exp(f.logClutterDensity(measurementOf(0, 0, range, 4), s)) * dr;
    one_edge += std::exp(f.logClutterDensity(measurementOf(0.1, 0, range, 5), s)) * dr * fov;
    // Both edges: over the middle (fov) and the angle between them, up to a width of 10 m.
    all += std::exp(f.logClutterDensity(measurementOf(0.1, -0.1, range, 7), s)) * dr * fov *
           (10 / range);
  }
  EXPECT_NEAR(range_only, 0.7, 1e-3);
  EXPECT_NEAR(one_edge, 0.7, 1e-3);
  EXPECT_NEAR(all, 0.7, 1e-3);
}

TEST(FootprintModel, BirthDensityTellsAPersonFromAVehicleByWidth) {
  const FootprintModel f = model();
  const SensorState s = sensorAt(0, 0, 0);
  const auto ratio = [&](double width) {
    const auto m = measurementOf(width / 40, -width / 40, 20, 7);
    return f.logBirthDensity(m, 1, s) - f.logBirthDensity(m, 0, s);  // person against car
  };
  EXPECT_GT(ratio(0.5), 2);
  EXPECT_LT(ratio(4.0), -2);
}

TEST(FootprintModel, TheBoxOfATruckBesideTheSensorTellsItFromACar) {
  ClassTable classes = footprintClasses();
  ObjectClass truck = classes.classes[0];
  truck.name = "truck";
  truck.length = 11, truck.width = 2.55, truck.length_sigma = 1.65, truck.width_sigma = 0.38;
  classes.classes.push_back(truck);
  for (const std::size_t vehicle : {0, 2}) classes.classes[vehicle].shape = ObjectShape::kVehicle;
  const FootprintModel f(classes, DetectionModel({}, {{}, {}, {}}, {"car_sized", "person_sized"}));
  const SensorState s = sensorAt(0, 0, 0);
  const Kinematics beside = rectangle(6, -3.7, 0);
  const Extent size{9.8, 2.5, 0, 0};
  AxisPrediction p;
  f.predict(&beside, &size, 1, s, &p);
  Measurement m;
  m.seen = FootprintModel::kAll;
  m.z = p.h;
  m.R = Vector3(0.003, 0.003, 0.06).asDiagonal();
  const auto log_odds = [&](ClassId a, ClassId b) {
    return f.logBirthDensity(m, a, s) - f.logBirthDensity(m, b, s);
  };
  const auto vehicles = [&] {
    return std::exp(f.logBirthDensity(m, 0, s)) + std::exp(f.logBirthDensity(m, 2, s));
  };
  EXPECT_LT(log_odds(2, 0), 0) << "its angle at the range of its nearest point is that of a car";
  const double person = f.logBirthDensity(m, 1, s), all = vehicles();
  PartialBox box;
  box.length = 9.8, box.width = 2.5, box.center = Vector2(6, -3.7);
  m.sides = box;
  EXPECT_GT(log_odds(2, 0), 2);
  EXPECT_EQ(f.logBirthDensity(m, 1, s), person) << "no other class has its shape";
  EXPECT_NEAR(vehicles(), all, 1e-9 * all) << "shapes are told apart as before";
}

TEST(FootprintModel, TheWidthThatAShapeHasToldCountsLessBetweenShapesAndAsMuchTogether) {
  ClassTable classes = footprintClasses();
  classes.classes[0].shape = ObjectShape::kVehicle;
  classes.classes[1].shape = ObjectShape::kPedestrian;
  const FootprintModel f(classes, DetectionModel({}, {{}, {}}, {"car_sized", "person_sized"}));
  const SensorState s = sensorAt(0, 0, 0);
  auto m = measurementOf(0.1, -0.1, 20, 7);  // 4 m wide
  m.log_class = {1, 0};
  const auto log_odds = [&] { return f.logBirthDensity(m, 0, s) - f.logBirthDensity(m, 1, s); };
  const auto together = [&] {
    double sum = 0;
    for (const ClassId c : {0, 1})
      sum += classes[c].prior *
             std::exp(m.log_class[static_cast<std::size_t>(c)] + f.logBirthDensity(m, c, s));
    return sum;
  };
  const double by_width = log_odds(), all = together();
  m.view.emplace();
  EXPECT_NEAR(log_odds(), 0.4 * by_width, 1e-9);
  EXPECT_GT(by_width, 2);
  EXPECT_NEAR(together(), all, 1e-9 * all) << "how likely a newborn is does not change";
}

TEST(FootprintModel, ARearViewStandsAcrossAndTheCarLiesBehindIt) {
  const FootprintModel f = model();
  Measurement m = measurementOf(0.045, -0.045, 20, 7);
  PartialBox sides;
  sides.yaw = kPi / 2;  // the seen side runs across the line of sight
  sides.yaw_sigma = 0.05;
  sides.length = 1.8;
  sides.width = 0.2;
  sides.length_complete = true;
  sides.center = {20.1, 0};
  m.sides = sides;
  const auto birth = f.birth(m, 0, sensorAt(0, 0, 0));
  ASSERT_TRUE(birth && birth->yaw);
  EXPECT_NEAR(wrapAxis(birth->yaw->mean), 0, 1e-9);
  EXPECT_NEAR(birth->position.x(), 20 + 4.5 / 2, 0.2);
  EXPECT_NEAR(birth->position.y(), 0, 1e-9);
  EXPECT_FALSE(f.birth(m, 1, sensorAt(0, 0, 0))->yaw);  // a person has no heading from a box
}

TEST(FootprintModel, ALongSideIsTheLength) {
  const FootprintModel f = model();
  Measurement m = measurementOf(0.1, -0.1, 20, 7);
  PartialBox sides;
  sides.yaw = 0.3;
  sides.yaw_sigma = 0.05;
  sides.length = 4.2;
  sides.width = 0.3;
  sides.center = {20, 0};
  m.sides = sides;
  const auto birth = f.birth(m, 0, sensorAt(0, 0, 0));
  ASSERT_TRUE(birth && birth->yaw);
  EXPECT_NEAR(wrapAxis(birth->yaw->mean - 0.3), 0, 1e-9);
  sides.yaw_sigma = 0.8;  // a round thing has no direction
  m.sides = sides;
  EXPECT_FALSE(f.birth(m, 0, sensorAt(0, 0, 0))->yaw);
}

}  // namespace
}  // namespace perception
