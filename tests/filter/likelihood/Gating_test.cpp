#include "libperception/filter/likelihood/Gating.h"

#include <gtest/gtest.h>

#include "libperception/core/math/Random.h"
#include "libperception/filter/likelihood/Innovation.h"
#include "libperception/filter/likelihood/LikelihoodTable.h"
#include "libperception/filter/predict/Prediction.h"
#include "libperception/filter/state/ClassFilterMotion.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

ClassFilter randomFilter(Rng& rng) {
  ClassFilter f;
  Matrix4 root;
  for (int i = 0; i < 16; ++i) root(i / 4, i % 4) = rng.normal(0, 0.5);
  f.P = root * root.transpose();
  f.x << rng.normal(0, 3), rng.normal(0, 3), rng.normal(), rng.normal();
  return f;
}

TEST(AxisBounds, ExcludeNoPairThatPassesTheGateAndMostThatDoNot) {
  Rng rng({8, 0, 0, 0});
  const PositionModel model(test::linearSensor());
  const ClassTable classes = test::linearClasses();
  const double gate = Gates::of(0.999).quantile[2];
  int outside = 0, excluded = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const ClassFilter f = randomFilter(rng);
    const Kinematics k = kinematicsOf(classes[0], f);
    AxisPrediction h;
    model.predict(&k, &f.extent, 1, {}, &h);
    Measurement m;
    m.z = Vector2(rng.normal(0, 5), rng.normal(0, 5));
    m.R = 0.01 * Matrix2::Identity();
    m.seen = 3;
    const Innovation i = innovationOf(f, k, h, m, model);
    const bool passes = i.y.dot(i.S.inverse() * i.y) <= gate;
    const bool out = AxisBounds(f, k, h).exclude(m, model.axes(), gate);
    ASSERT_FALSE(passes && out) << trial;
    outside += !passes;
    excluded += out;
  }
  EXPECT_GT(excluded, outside / 2);
}

TEST(BoundingDisc, HoldEveryPairThatIsCoarselyNear) {
  Rng rng({9, 0, 0, 0});
  for (int trial = 0; trial < 2000; ++trial) {
    Track t;
    for (int j = 0; j < 3; ++j) t.bank.push_back(randomFilter(rng));
    Measurement m;
    m.position = {rng.normal(0, 20), rng.normal(0, 20)};
    ASSERT_TRUE(BoundingDisc(t).mayBeNear(m) || !coarseGate(t, m)) << trial;
  }
}

/// A pedestrian, a pole and a car whose heading is known more or less, all about one place.
Track threeClasses(Rng& rng) {
  Track t;
  t.stamp = Stamp::fromSeconds(1000);
  t.existence = 0.9;
  const Vector2 place(rng.normal(0, 60), rng.normal(0, 60));
  for (int j = 0; j < 3; ++j) {
    ClassFilter f = randomFilter(rng);
    f.x.head<2>() += place;
    f.extent = {rng.uniform(0.3, 6), rng.uniform(0.3, 2), 0.1, 0.1};
    t.bank.push_back(f);
    t.log_class.push_back(std::log(1. / 3));
  }
  t.bank[1].x.tail<2>().setZero();
  t.bank[2].x[2] = rng.normal(0, 12);
  t.bank[2].oriented = true;
  return t;
}

TEST(MayBeInView, EveryScanThatCouldSeeThePredictedTrack) {
  const FilterModel model = test::threeClassModel();
  PositionModel::Params params = test::linearSensor();
  params.classes.push_back(params.classes[0]);
  params.fov = radians(90);
  params.range = 60;
  const auto sensor = std::make_shared<const PositionModel>(params);
  Rng rng({10, 0, 0, 0});
  int deferred = 0, unseen = 0;
  constexpr int kTrials = 4000;
  for (int trial = 0; trial < kTrials; ++trial) {
    Track t = threeClasses(rng);
    t.reachable = reachableDiscOf(t, model);
    const bool short_deferral = trial % 2 == 0;  // the longer, the wider the bound
    const double dt = rng.uniform(0, 0.999 * (short_deferral ? 0.5 : kLongestDeferral));
    MeasurementScan scan = test::positionScan(sensor, dt, {});
    scan.state.T_world_sensor = makePose(0, 0, 0, rng.uniform(-kPi, kPi), 0, 0);
    const Track later = predictTrack(t, scan.state.stamp, model);
    for (const ClassFilter& f : later.bank) {  // boxes right on it
      scan.measurements.push_back(
          test::positionScan(sensor, dt, {{f.x[0], f.x[1], 0}}).measurements[0]);
    }
    const TrackLikelihoods row = likelihoodTable({later}, scan, model).tracks[0];
    const bool seen = row.in_view || row.detection > 0 || !row.pairs.empty();
    ASSERT_TRUE(mayBeInView(scan, t) || !seen) << trial;
    deferred += short_deferral && !mayBeInView(scan, t);
    unseen += short_deferral && !seen;
  }
  EXPECT_GT(deferred, unseen / 2);
}

TEST(MayBeInView, WhateverIsNotPlacedYetOrLeftBehindForLong) {
  const FilterModel model = test::threeClassModel();
  PositionModel::Params params = test::linearSensor();
  params.range = 1;
  const auto sensor = std::make_shared<const PositionModel>(params);
  Rng rng({11, 0, 0, 0});
  Track t = threeClasses(rng);
  t.bank[0].x[0] = t.bank[1].x[0] = t.bank[2].x[0] = 500;
  EXPECT_TRUE(mayBeInView(test::positionScan(sensor, 0.1, {}), t));
  t.reachable = reachableDiscOf(t, model);
  EXPECT_FALSE(mayBeInView(test::positionScan(sensor, 0.1, {}), t));
  EXPECT_TRUE(mayBeInView(test::positionScan(sensor, kLongestDeferral, {}), t));
}

TEST(MayBeInView, WhateverHasMotionModesAfterHalfASecond) {
  const FilterModel model = test::threeClassModel();
  PositionModel::Params params = test::linearSensor();
  params.range = 1;
  const auto sensor = std::make_shared<const PositionModel>(params);
  Rng rng({13, 0, 0, 0});
  Track t = threeClasses(rng);
  for (ClassFilter& f : t.bank) f.x[0] = 500;
  t.bank[0].modes.push_back({0, t.bank[0].x, t.bank[0].P});
  t.reachable = reachableDiscOf(t, model);
  EXPECT_FALSE(mayBeInView(test::positionScan(sensor, 0.4, {}), t));
  EXPECT_TRUE(mayBeInView(test::positionScan(sensor, kLongestDeferralOfModes, {}), t));
}

TEST(ReachableDisc, ExpireWhenThePredictedExistenceIsTooSmall) {
  FilterModel model = test::threeClassModel();
  model.params.existence_min = 0.01;
  Rng rng({14, 0, 0, 0});
  for (int trial = 0; trial < 300; ++trial) {
    Track t = threeClasses(rng);
    t.existence = rng.uniform(0.011, 1);
    t.last_in_view = t.stamp + rng.uniform(-2, 0);
    model.params.survival_in_view = rng.uniform(0.1, 10);
    model.params.survival_out_of_view = rng.uniform(0.1, 10);
    model.params.existence_decay = trial % 3 == 0 ? 3 : 0;
    const Stamp expires = reachableDiscOf(t, model).expires;
    EXPECT_NEAR(predictOdds(t, expires, model).existence, 0.01, 1e-6) << trial;
  }
}

TEST(TouchesSector, LikeTheAnglesSay) {
  Rng rng({12, 0, 0, 0});
  int touching = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    SensorState state;
    const double yaw = rng.uniform(-kPi, kPi), fov = rng.uniform(0.1, kTwoPi);
    state.T_world_sensor = makePose(3, -2, 1, yaw, 0, 0);
    const Vector2 center(rng.normal(3, 30), rng.normal(-2, 30));
    const Vector2 d = center - Vector2(3, -2);
    const double reach = rng.uniform(0, 20), distance = d.norm();
    const double off = std::abs(wrapAngle(std::atan2(d.y(), d.x()) - yaw));
    const bool within = distance - reach <= 40;
    const bool touches =
        within && (distance <= reach || off - std::asin(reach / distance) <= 0.5 * fov);
    ASSERT_EQ(touchesSector(center, reach, fov, 40, state), touches) << trial;
    touching += touches;
  }
  EXPECT_GT(touching, 1000);
}

}  // namespace
}  // namespace perception
