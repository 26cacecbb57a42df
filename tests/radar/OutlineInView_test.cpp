#include "libperception/radar/OutlineInView.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Random.h"
#include "libperception/measurement/models/FootprintModel.h"
#include "libperception/radar/RadarModel.h"

namespace perception {
namespace {

const double kHalf = radians(7.5);  // Delphi's beam

FootprintModel footprint() {
  ObjectClass car;
  car.name = "car";
  return FootprintModel({{car}}, DetectionModel({}, {{}}, {"target"}));
}

OutlineInView part(const Kinematics& k, const Extent& e, double half = kHalf) {
  SensorState s;
  AxisPrediction outline;
  footprint().predict(&k, &e, 1, s, &outline);
  return outlineInView(outline, k, e, s, half);
}

Kinematics objectAt(double x, double y, double yaw, bool has_yaw = true) {
  Kinematics k;
  k.q << x, y, 0, 0, yaw;
  k.has_yaw = has_yaw;
  return k;
}

/// Points of the outline, dense enough for a centimeter.
std::vector<Vector2> outlinePoints(const Kinematics& k, const Extent& e) {
  std::vector<Vector2> points;
  constexpr int kSteps = 2000;
  for (int i = 0; i < kSteps; ++i) {
    const double share = (i + 0.5) / kSteps;
    if (!k.has_yaw) {
      const double radius = 0.25 * (e.length + e.width), a = kTwoPi * share;
      points.push_back(k.q.head<2>() + radius * Vector2(std::cos(a), std::sin(a)));
      continue;
    }
    const double along = e.length * (share - 0.5), across = e.width * (share - 0.5);
    for (const double side : {-0.5, 0.5}) {
      points.push_back(k.q.head<2>() + rotate2(k.q[4], {along, side * e.width}));
      points.push_back(k.q.head<2>() + rotate2(k.q[4], {side * e.length, across}));
    }
  }
  return points;
}

TEST(OutlineInView, NearestPointIsThatOfThePartInView) {
  Rng rng({21, 0, 0, 0});
  int cut = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Kinematics k =
        objectAt(rng.uniform(5, 25), rng.uniform(-6, 6), rng.uniform(-3, 3), trial % 3 != 0);
    const Extent e{rng.uniform(2, 12), rng.uniform(1, 2.6), 0, 0};
    double nearest = 1e9, left = -1e9, right = 1e9;
    for (const Vector2& p : outlinePoints(k, e)) {
      const double bearing = std::atan2(p.y(), p.x());
      if (std::abs(bearing) > kHalf) continue;
      nearest = std::min(nearest, p.norm());
      left = std::max(left, bearing), right = std::min(right, bearing);
    }
    if (left < right + radians(0.5)) continue;  // hardly in view
    const OutlineInView seen = part(k, e);
    cut += seen.left_cut || seen.right_cut;
    EXPECT_NEAR(seen.range, nearest, 0.02 + 0.02 * nearest);
    EXPECT_NEAR(seen.left, left, radians(0.3));
    EXPECT_NEAR(seen.right, right, radians(0.3));
  }
  EXPECT_GT(cut, 100);
}

TEST(OutlineInView, FlankOfAPassingVehicleIsSeenBehindItsNose) {
  // Along the lane beside ours: its nose is out of the beam, its flank enters at the border.
  const OutlineInView seen = part(objectAt(16, 2.5, kPi), {5.57, 2, 0, 0}, radians(6));
  EXPECT_TRUE(seen.left_cut);
  EXPECT_NEAR(seen.range * std::sin(seen.left), 1.5, 1e-9);
  EXPECT_GT(seen.range, 14);
}

TEST(OutlineInView, WideViewsAndObjectsOutsideStayWhole) {
  const Extent e{4.5, 1.8, 0, 0};
  for (const double half : {radians(90), radians(180)}) {
    const OutlineInView seen = part(objectAt(3, 5, 0.3), e, half);
    EXPECT_FALSE(seen.left_cut || seen.right_cut);
  }
  const OutlineInView outside = part(objectAt(10, 8, 0.3), e);
  EXPECT_FALSE(outside.left_cut || outside.right_cut);
}

TEST(OutlineInView, JacobiansAreTheDerivatives) {
  Rng rng({22, 0, 0, 0});
  int same = 0, total = 0, cut = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Kinematics k =
        objectAt(rng.uniform(6, 40), rng.uniform(-6, 6), rng.uniform(-3, 3), trial % 2 == 0);
    const Extent e{rng.uniform(1, 12), rng.uniform(1, 2.6), 1, 1};
    const OutlineInView seen = part(k, e);
    if (!seen.left_cut && !seen.right_cut) continue;
    ++cut;
    const double h = 1e-6;
    for (int column = 0; column < 5; ++column, ++total) {
      Kinematics up = k, down = k;
      up.q[column] += h, down.q[column] -= h;
      same += std::abs((part(up, e).range - part(down, e).range) / (2 * h) - seen.range_q[column]) <
              1e-4;
    }
    Extent up = e, down = e;
    up.length += h, down.length -= h;
    same +=
        std::abs((part(k, up).range - part(k, down).range) / (2 * h) - seen.range_extent[0]) < 1e-4;
    ++total;
  }
  EXPECT_GT(cut, 500);
  EXPECT_GE(same, total - total / 50);  // sides seen along themselves have a bound in place of it
}

TEST(RadarModel, WhatReachesIntoTheBeamIsDetected) {
  DetectionParams p;
  p.modality = Modality::kRadar;
  p.fov = 2 * kHalf;
  ObjectClass bus;
  bus.name = "bus";
  const RadarModel model({{bus}}, DetectionModel(p, {{}}, {"target"}), {});
  const Extent e{11, 2.55, 0, 0};
  const SensorState s;
  const auto detection = [&](double y) {
    return model.detectionProbability(0, objectAt(20, y, kPi / 2), e, s, 1);
  };
  EXPECT_NEAR(detection(0), 0.9, 1e-3);
  EXPECT_NEAR(detection(5), 0.9, 1e-3);  // center at 14 deg, its end on the axis
  EXPECT_EQ(detection(11), 0);           // its end at 15 deg
  EXPECT_NEAR(detection(7.85), 0.65, 0.1);
  EXPECT_LT(detection(8.6), 0.4);
}

TEST(RadarModel, AVehicleAtTheBumperIsTooNearToBeDetected) {
  DetectionParams p;
  p.modality = Modality::kRadar;
  p.fov = 2 * kHalf;
  p.range_min = 1;
  ObjectClass car;
  car.name = "car";
  const RadarModel model({{car}}, DetectionModel(p, {{}}, {"target"}), {});
  const Extent e{4.5, 1.8, 0, 0};
  const auto detected = [&](double gap) {  // [m] from the radar to the rear of the vehicle ahead
    return model.detectionProbability(0, objectAt(gap + e.length / 2, 0, 0), e, SensorState(), 1);
  };
  EXPECT_NEAR(detected(10), 0.9, 1e-3);
  EXPECT_NEAR(detected(2.5), 0.9, 1e-3);
  EXPECT_NEAR(detected(1.5), 0.45, 0.01);
  EXPECT_LT(detected(0.5), 0.02);
}

}  // namespace
}  // namespace perception
