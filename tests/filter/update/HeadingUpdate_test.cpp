#include "libperception/filter/update/HeadingUpdate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Random.h"
#include "libperception/filter/state/ClassFilterMotion.h"

namespace perception {
namespace {

constexpr double kSigma = 0.13;  // [rad] of the detector's axis

/// A car at (10, 0) that stands, or drives along its axis with a speed known to 0.3 m/s.
ClassFilter car(double theta, double v = 0) {
  ClassFilter f;
  f.x << 10, 0, v, theta;
  f.P = Vector4(0.04, 0.04, v != 0 ? 0.09 : 1.0, 0.01).asDiagonal();
  f.oriented = true;
  return f;
}

MeasuredHeading seenHeading(double yaw) { return {yaw, kSigma, 0.05}; }

/// The axis' error [rad] after `n` headings of `yaw`, the axis kept as certain as edges keep it.
double after(int n, double yaw, ClassFilter& f) {
  for (int i = 0; i < n; ++i) {
    f.P(3, 3) = 0.03;
    useHeading(seenHeading(yaw), {}, f);
  }
  return std::abs(wrapAxis(f.x[3] - yaw));
}

TEST(HeadingUpdate, ComesBackFromAnAxisThatTheDetectorDenies) {
  ClassFilter f = car(0);
  ASSERT_LT(after(5, 0, f), 0.01);
  EXPECT_GT(after(1, 0.8, f), 0.7) << "one stray box moves nothing";
  EXPECT_LT(after(1, 0.8, f), 0.05) << "a detector that insists is believed";
  EXPECT_EQ(f.heading.same, 1) << "of the new axis nothing older is known";
}

TEST(HeadingUpdate, AnAxisThatNoDetectorToldGivesWayToTheFirst) {
  ClassFilter f = car(0);
  EXPECT_LT(after(1, 0.8, f), 1e-9);
}

TEST(HeadingUpdate, AClearMotionHoldsItsAxis) {
  ClassFilter f = car(0, 8);
  EXPECT_GT(after(20, 0.8, f), 0.7);
  EXPECT_NEAR(f.x[2], 8, 1e-9);
}

/// Whether one of `n` boxes of a lidar with their long side along `yaw` denies the car's axis.
bool deniedBy(int n, double yaw, ClassFilter& f) {
  Measurement m;
  m.sides.emplace();
  BirthState box;
  box.yaw = ScalarEstimate{yaw, 0.01};
  for (int i = 0; i < n; ++i)
    if (boxDeniesAxis(m, box, {}, f)) return true;
  return false;
}

TEST(HeadingUpdate, BoxesAcrossItsAxisDenyIt) {
  ClassFilter f = car(0);
  ASSERT_FALSE(deniedBy(10, 0.1, f));
  EXPECT_FALSE(deniedBy(4, kPi / 2, f)) << "a view may show the wrong side";
  EXPECT_TRUE(deniedBy(4, kPi / 2, f));
}

TEST(HeadingUpdate, BoxesDoNotDenyTheAxisAlongWhichItHasDriven) {
  ClassFilter f = car(0, 8);
  ASSERT_FALSE(deniedBy(1, 0, f));
  f.x[2] = 0;  // it stands at a light, a van seenHeading from behind
  EXPECT_FALSE(deniedBy(20, kPi / 2, f));
}

/// After `n` boxes along `yaw` whose shape tells their front by `log_odds`.
void seeBoxes(int n, double yaw, double log_odds, ClassFilter& f) {
  Measurement m;
  m.sides.emplace();
  m.sides->yaw = yaw;
  m.sides->front_log_odds = log_odds;
  for (int i = 0; i < n; ++i) findHeading(m, {}, {}, f);
}

TEST(HeadingUpdate, AParkedCarIsTurnedToTheFrontThatItsShapeTells) {
  ClassFilter f = car(0.2);
  seeBoxes(3, 0.2, -3, f);
  EXPECT_NEAR(std::abs(wrapAngle(f.x[3] - 0.2)), kPi, 1e-9);
  EXPECT_GT(f.heading.frontProbability(), 0.95);
  seeBoxes(20, 0.2, -3, f);
  EXPECT_NEAR(std::abs(wrapAngle(f.x[3] - 0.2)), kPi, 1e-9) << "and stays so";
  EXPECT_LT(f.heading.frontProbability(), 0.96) << "views of one car err alike";
}

TEST(HeadingUpdate, AClearSpeedOutweighsTheShape) {
  ClassFilter f = car(0.2, 8);
  seeBoxes(20, 0.2, -3, f);
  EXPECT_NEAR(f.x[3], 0.2, 1e-9);
  EXPECT_EQ(f.x[2], 8);
}

TEST(HeadingUpdate, ShapesOfBoxesAcrossTheAxisTellNothing) {
  ClassFilter f = car(0.2);
  seeBoxes(20, 0.2 + kPi / 2, -3, f);
  EXPECT_EQ(f.heading.frontProbability(), 0.5);
}

TEST(HeadingUpdate, ReversedHeadingsAreNoOtherAxis) {
  ClassFilter f = car(0.3);
  for (int i = 0; i < 20; ++i) after(1, i % 3 == 0 ? 0.3 + kPi : 0.3, f);
  EXPECT_NEAR(f.x[3], 0.3, 0.02);
  EXPECT_GT(f.heading.axis_log_odds, 4);
}

TEST(HeadingUpdate, StrayAxesOfADetectorAreLeftOut) {
  // One axis in a hundred is anywhere: the track must be better than the detector's own boxes.
  Rng rng({11, 0, 0, 0});
  ClassFilter f = car(0);
  double square = 0, own = 0;
  constexpr int kBoxes = 20000;
  for (int i = 0; i < kBoxes; ++i) {
    const bool stray = rng.uniform() < 0.01;
    const double yaw = stray ? rng.uniform(-kPi / 2, kPi / 2) : rng.normal(0, kSigma);
    f.P(3, 3) += 0.0002;
    useHeading(seenHeading(yaw), {}, f);
    square += std::pow(wrapAxis(f.x[3]), 2), own += std::pow(wrapAxis(yaw), 2);
  }
  EXPECT_LT(std::sqrt(square / kBoxes), 0.5 * std::sqrt(own / kBoxes));
}

/// The facing of a pedestrian with headings seen to the north who goes `way` [m] north.
double facingAfterWalk(int headings, double way, Modality seen_by = Modality::kLidar) {
  FilterModel model;
  model.classes.classes.resize(1);
  model.classes.classes[0].motion = findMotionModel("constant-velocity");
  Track track;
  track.log_class = {0};
  track.bank.resize(1);
  track.last_hit[modalityIndex(seen_by)] = Stamp{1};
  for (int i = 0; i < headings; ++i) updateBodyHeading({kPi / 2, kSigma, 0.2}, model.params, track);
  for (int i = 0; i <= 20; ++i) {
    track.bank[0].x << 5, 5 + 0.05 * i * way, 0, 0;
    faceTheWay(model, track);
  }
  return track.body_heading->mean;
}

TEST(HeadingUpdate, PeopleFaceTheWayTheyWalk) {
  EXPECT_NEAR(facingAfterWalk(1, 4), kPi / 2, 1e-9);
  EXPECT_NEAR(facingAfterWalk(1, -4), -kPi / 2, 1e-9) << "one reversed heading";
  EXPECT_NEAR(facingAfterWalk(1, -1), kPi / 2, 1e-9) << "no walk";
  EXPECT_NEAR(facingAfterWalk(1, -4, Modality::kCamera), kPi / 2, 1e-9) << "images alone drift";
  EXPECT_NEAR(facingAfterWalk(20, -4), kPi / 2, 1e-9) << "a detector that insists is believed";
}

TEST(HeadingUpdate, ReorientingKeepsTheVelocityAlong) {
  ClassFilter f = car(0, 4);
  reorient(kPi / 3, 0.02, f);
  EXPECT_NEAR(f.x[2], 4 * std::cos(kPi / 3), 1e-9);
  EXPECT_NEAR(f.x[3], kPi / 3, 1e-12);
  EXPECT_NEAR(f.P(3, 3), 0.02, 1e-12);
  // Var of the speed along: that of v along it, and of theta's part across times v^2.
  EXPECT_NEAR(f.P(2, 2), 0.25 * 0.09 + 0.75 * 16 * 0.01, 1e-9);
}

}  // namespace
}  // namespace perception
