#include "libperception/filter/update/VelocityUpdate.h"

#include <gtest/gtest.h>

#include "libperception/filter/predict/Prediction.h"
#include "libperception/filter/state/ClassFilterMotion.h"
#include "libperception/filter/update/Update.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

RadialSpeed speedOf(double mean, double sigma, const Vector2& direction = Vector2::UnitX()) {
  RadialSpeed seen;
  seen.direction = direction.normalized();
  seen.along = {mean, sigma * sigma};
  return seen;
}

/// At the origin; velocity 0 with a deviation of 5 m/s.
ClassFilter unknown() {
  ClassFilter f;
  f.P.diagonal() << 1, 1, 25, 25;
  return f;
}

ClassFilter oriented(double yaw, double speed) {
  ClassFilter f;
  f.oriented = true;
  f.x << 0, 0, speed, yaw;
  f.P.diagonal() << 1, 1, 4, 0.01;
  return f;
}

TEST(VelocityUpdate, MeasuresTheComponentAlongItsDirectionAlone) {
  ClassFilter f = unknown();
  updateVelocity(speedOf(14, 1, {3, 4}), f);
  const double gain = 25.0 / 26;
  EXPECT_NEAR(f.x[2], 0.6 * gain * 14, 1e-9);
  EXPECT_NEAR(f.x[3], 0.8 * gain * 14, 1e-9);
  const Vector2 across(-0.8, 0.6);
  EXPECT_NEAR(across.dot(f.P.bottomRightCorner<2, 2>() * across), 25, 1e-9);
  EXPECT_NEAR(f.x[0], 0, 1e-12);
}

TEST(VelocityUpdate, TheComponentAcrossMayBeBounded) {
  ClassFilter f = unknown();
  RadialSpeed seen = speedOf(14, 1);
  seen.across_sigma = 1;
  updateVelocity(seen, f);
  EXPECT_NEAR(f.P(3, 3), 25.0 / 26, 1e-9);
}

TEST(VelocityUpdate, OfASlowAndAFastObjectTheOneThatFitsBecomesLikely) {
  ClassFilter f = unknown();
  startTwoSpeeds(0.3, 25, f);
  updateVelocity(speedOf(25, 1), f);
  ASSERT_EQ(f.modes.size(), 2u);
  EXPECT_GT(std::exp(f.modes[1].log_probability), 0.99);
  EXPECT_NEAR(f.x[2], 25, 0.5);
}

TEST(VelocityUpdate, AnOrientedObjectGetsItsSpeedAlongItsHeading) {
  ClassFilter f = oriented(0.2, 10);
  updateVelocity(speedOf(14 * std::cos(0.2), 0.1), f);
  EXPECT_NEAR(f.x[2], 14, 0.1);
  EXPECT_NEAR(f.x[3], 0.2, 0.1);
}

TEST(VelocityUpdate, AHeadingAcrossTheMotionIsDenied) {
  const RadialSpeed seen = speedOf(25, 2.5);
  EXPECT_TRUE(deniesHeading(seen, oriented(kPi / 2, 8)));
  EXPECT_FALSE(deniesHeading(seen, oriented(0.1, 22)));
  EXPECT_FALSE(deniesHeading(speedOf(-2, 2.5), oriented(kPi / 2, 8)));
  EXPECT_FALSE(deniesHeading(seen, unknown())) << "it has none";
}

/// How much likelier 14 m/s make a walker than what never moves.
double gainOf(double mean) {
  const ClassTable classes = test::linearClasses();
  const RadialSpeed seen = speedOf(mean, 1);
  return logRadialSpeed(classes[0], unknown(), seen) - logRadialSpeed(classes[1], {}, seen);
}

TEST(VelocityUpdate, WhatMovesIsNothingThatNeverDoes) {
  EXPECT_GT(gainOf(8), 3);
  EXPECT_LT(gainOf(8), 6) << "it may be the speed of something else";
  EXPECT_LT(gainOf(0), -1);
}

/// What a car drives at [m/s] whose cluster moved at 14 m/s in its `hit`-th detection.
double speedAfter(int hit) {
  FilterModel model = test::threeClassModel();
  model.classes.classes[2].max_speed = 50;
  auto params = test::linearSensor();
  params.classes.push_back(params.classes[0]);
  const auto sensor = std::make_shared<const PositionModel>(params);
  const auto seen = speedOf(14, 1);
  auto scan = test::positionScan(sensor, 0, {{10, 0, 0}});
  if (hit == 1) scan.measurements[0].radial_speed = seen;
  Track t = newTrack(likelihoodTable({}, scan, model).births[0], 0, scan, 0, model);
  for (int k = 1; k < hit; ++k) {
    scan = test::positionScan(sensor, 0.1 * k, {{10, 0, 0}});
    if (k + 1 == hit) scan.measurements[0].radial_speed = seen;
    t = predictTrack(t, scan.state.stamp, model);
    const auto table = likelihoodTable({t}, scan, model);
    t = hitTrack(t, table.tracks[0], table.tracks[0].pairs.at(0), scan,
                 static_cast<std::uint64_t>(k), model);
  }
  return kinematicsOf(model.classes[2], t.bank[2]).q.segment<2>(2).norm();
}

TEST(VelocityUpdate, ANewbornDrivesAsItsClusterMoved) {
  EXPECT_GT(speedAfter(1), 10);
  EXPECT_GT(speedAfter(2), 10);
}

TEST(VelocityUpdate, AfterFourDetectionsPositionsTellTheSpeed) { EXPECT_LT(speedAfter(5), 2); }

}  // namespace
}  // namespace perception
