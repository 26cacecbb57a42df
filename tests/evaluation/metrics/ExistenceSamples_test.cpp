#include <gtest/gtest.h>

#include "libperception/evaluation/metrics/Metrics.h"
#include "tests/evaluation/MakeRun.h"

namespace perception {
namespace {

using namespace testing_evaluation;

SceneObject believed(SceneObject object, double existence) {
  object.existence = existence;
  return object;
}

Evaluation evaluateObjects(std::vector<SceneObject> objects,
                           const EvaluationOptions& options = {}) {
  TrackedRun run = makeRun();
  run.scenes = {makeScene(0, std::move(objects))};
  return evaluate(run, makeGroundTruth({makeTruth(0, 5, 10, 0)}), options);
}

TEST(Existence, APairedOutputIsRealAndALonelyOneIsNot) {
  const auto e =
      evaluateObjects({believed(makeObject(1, 10.5, 0), .9), believed(makeObject(2, 5, 8), .6)});
  ASSERT_EQ(e.existence.size(), 2u);
  EXPECT_TRUE(e.existence[0].real);
  EXPECT_FALSE(e.existence[1].real);
}

TEST(Existence, AnObjectPutOutTwiceIsRealOnce) {
  const auto e =
      evaluateObjects({believed(makeObject(1, 10.5, 0), .9), believed(makeObject(2, 9.6, 0), .8)});
  ASSERT_EQ(e.existence.size(), 2u);
  EXPECT_NE(e.existence[0].real, e.existence[1].real);
}

TEST(Existence, WhatStandsNearATruthWithoutBeingItSaysNothing) {
  EXPECT_TRUE(evaluateObjects({believed(makeObject(1, 12.5, 0), .9)}).existence.empty());
}

TEST(Existence, TheCalibrationErrorIsTheGapWeightedByOutputs) {
  const auto e =
      evaluateObjects({believed(makeObject(1, 10, 0), .75), believed(makeObject(2, 5, 8), .75)});
  const Reliability r = existenceReliability(e);
  ASSERT_TRUE(r.calibration_error);
  EXPECT_NEAR(*r.calibration_error, 0.25, 1e-12);  // said .75, half are
  EXPECT_EQ(r.bins[7].count, 2u);
}

TEST(Existence, LowOutputsAreLeftOutOfAllOtherFigures) {
  EvaluationOptions options;
  options.min_existence = 0.5;
  const auto e = evaluateObjects(
      {believed(makeObject(1, 10, 0), .3), believed(makeObject(2, 5, 8), .2)}, options);
  EXPECT_EQ(e.existence.size(), 2u);
  EXPECT_EQ(e.instants[0].allOutputs().named, 0u);
  EXPECT_EQ(*trackingFigures(e, Pairing::kClosest).tracked_a, 0);
}

TEST(Existence, LowOutputsAreNoFalseObjectsOfMota) {
  const std::vector<SceneObject> outputs = {believed(makeObject(1, 10, 0), .9),
                                            believed(makeObject(2, 5, 8), .2)};
  EXPECT_EQ(clearFigures(evaluateObjects(outputs)).false_objects, 1U);
  EvaluationOptions options;
  options.min_existence = 0.5;
  EXPECT_EQ(clearFigures(evaluateObjects(outputs, options)).false_objects, 0U);
}

TEST(FalseObjects, AreKnownByTheirIdentities) {
  const auto e = evaluateObjects({makeObject(1, 10, 0), makeObject(9, 5, 8, kPedestrian)});
  ASSERT_EQ(e.instants[0].false_objects.size(), 1u);
  EXPECT_EQ(e.instants[0].false_objects[0].id, 9u);
  EXPECT_EQ(e.instants[0].false_objects[0].class_id, kPedestrian);
}

}  // namespace
}  // namespace perception
