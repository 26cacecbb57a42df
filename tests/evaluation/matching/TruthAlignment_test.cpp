#include "libperception/evaluation/matching/TruthAlignment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/evaluation/MakeRun.h"

namespace perception {
namespace {

using namespace testing_evaluation;

// A run of one scene without frame number at time t [s] of the log.
TrackedRun sceneAt(double t) {
  TrackedRun run = makeRun();
  Scene scene = makeScene(-1);
  scene.stamp = run.first_stamp + t;
  run.scenes.push_back(scene);
  return run;
}

TruthObject truthAt(double t, std::int64_t id, double x, double yaw = 0) {
  TruthObject object = makeTruth(-1, id, x, 0);
  object.t = t;
  object.yaw = yaw;
  return object;
}

TEST(TruthAlignment, PrefersFrameNumbersToTimes) {
  TrackedRun run = makeRun();
  run.scenes.push_back(makeScene(7));
  run.scenes.back().stamp = run.first_stamp + 3.0;  // the import's rate was another one
  const auto a =
      alignTruth(run, makeGroundTruth({makeTruth(7, 1, 5, 0), makeTruth(30, 1, 9, 0)}), {});
  ASSERT_EQ(a.instants.size(), 1u);
  EXPECT_EQ(a.instants[0].objects.at(0).position.x(), 5);
  EXPECT_EQ(a.by_frame, 1u);
  EXPECT_EQ(a.truth_without_scene, 1u);
}

TEST(TruthAlignment, InterpolatesBetweenNeighbors) {
  const auto truth = makeGroundTruth({truthAt(1.0, 1, 10, 3.1), truthAt(1.1, 1, 12, -3.1)});
  const auto a = alignTruth(sceneAt(1.025), truth, {});
  ASSERT_EQ(a.instants.size(), 1u);
  EXPECT_EQ(a.by_time, 1u);
  const TruthObject& object = a.instants[0].objects.at(0);
  EXPECT_NEAR(object.position.x(), 10.5, 1e-6);
  EXPECT_NEAR(object.yaw, 3.1 + 0.25 * (kTwoPi - 6.2), 1e-6);  // the short way round
  EXPECT_EQ(a.truth_without_scene, 0u);
}

TEST(TruthAlignment, GoesWithTheVehicleIntoAnotherWorld) {
  TruthObject object = truthAt(1.0, 1, 12);
  object.vx = 3;
  object.vy = 0;
  TrackedRun logged = sceneAt(1.0), odometry = sceneAt(1.0);
  logged.scenes[0].ego.T_world_ego = makePose(2, 0, 0, 0);  // 10 m behind the object
  odometry.scenes[0].ego.T_world_ego = makePose(100, 50, 0, kPi / 2);
  AlignmentOptions options;
  options.truth_poses = std::make_shared<TrackedRun>(logged);
  const auto a = alignTruth(odometry, makeGroundTruth({object}), options);
  ASSERT_EQ(a.instants.size(), 1u);
  const TruthObject& moved = a.instants[0].objects.at(0);
  EXPECT_NEAR(moved.position.x(), 100, 1e-9);
  EXPECT_NEAR(moved.position.y(), 60, 1e-9);
  EXPECT_NEAR(moved.yaw, kPi / 2, 1e-9);
  EXPECT_NEAR(moved.vy, 3, 1e-9);
  options.truth_poses = std::make_shared<TrackedRun>(sceneAt(5.0));
  EXPECT_EQ(alignTruth(odometry, makeGroundTruth({object}), options).scenes_without_truth, 1u);
}

TEST(TruthAlignment, HoldsItsLimitOfTime) {
  const auto truth = makeGroundTruth({truthAt(1.0, 1, 10)});
  EXPECT_EQ(alignTruth(sceneAt(1.059), truth, {}).by_time, 1u);
  EXPECT_EQ(alignTruth(sceneAt(0.941), truth, {}).by_time, 1u);
  EXPECT_EQ(alignTruth(sceneAt(1.061), truth, {}).scenes_without_truth, 1u);
  EXPECT_EQ(alignTruth(sceneAt(0.939), truth, {}).scenes_without_truth, 1u);
  AlignmentOptions wide;
  wide.time_limit = 0.2;
  EXPECT_EQ(alignTruth(sceneAt(1.15), truth, wide).by_time, 1u);
}

TEST(TruthAlignment, NeverInterpolatesOverAGap) {
  TruthObject moving = truthAt(1.0, 1, 10);
  moving.vx = 4;
  moving.vy = 0;
  const auto truth = makeGroundTruth({moving, truthAt(2.0, 1, 100)});
  const auto a = alignTruth(sceneAt(1.05), truth, {});
  ASSERT_EQ(a.instants.size(), 1u);
  EXPECT_NEAR(a.instants[0].objects.at(0).position.x(), 10.2, 1e-6);  // moved by its velocity
  EXPECT_EQ(alignTruth(sceneAt(1.5), truth, {}).scenes_without_truth, 1u);
}

TEST(TruthAlignment, AnObjectOfOneNeighborComesFromTheNearerOnly) {
  const auto truth = makeGroundTruth({truthAt(1.0, 1, 10), truthAt(1.1, 2, 20)});
  const auto a = alignTruth(sceneAt(1.02), truth, {});
  ASSERT_EQ(a.instants.at(0).objects.size(), 1u);
  EXPECT_EQ(a.instants[0].objects[0].id, 1);
}

TEST(TruthAlignment, ASceneWithoutTruthLineIsUnknownUnlessSaidToBeEmpty) {
  TrackedRun run = makeRun();
  run.scenes = {makeScene(0), makeScene(1)};
  const auto truth = makeGroundTruth({makeTruth(0, 1, 5, 0)});
  EXPECT_EQ(alignTruth(run, truth, {}).scenes_without_truth, 1u);
  AlignmentOptions empty;
  empty.empty_frames = true;
  const auto a = alignTruth(run, truth, empty);
  ASSERT_EQ(a.instants.size(), 2u);
  EXPECT_TRUE(a.instants[1].objects.empty());
  EXPECT_EQ(a.assumed_empty, 1u);
}

TEST(TruthAlignment, WithoutOverlapNothingIsCompared) {
  const auto a =
      alignTruth(sceneAt(500), makeGroundTruth({truthAt(1, 1, 5), truthAt(1.1, 1, 5)}), {});
  EXPECT_TRUE(a.instants.empty());
  EXPECT_EQ(a.scenes_without_truth, 1u);
  EXPECT_EQ(a.truth_without_scene, 2u);
  EXPECT_TRUE(alignTruth(sceneAt(1), GroundTruth(), {}).instants.empty());
}

}  // namespace
}  // namespace perception
