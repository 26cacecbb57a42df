#include "studies/association/LogParticlesStudy.h"

#include <gtest/gtest.h>

#include "libperception/evaluation/metrics/Metrics.h"

namespace perception {
namespace {

SceneObject object(std::uint64_t id, double x, ClassId c, bool classified) {
  SceneObject o;
  o.id = id;
  o.class_id = c;
  o.classified = classified;
  o.class_probability = {0.5, 0.5, 0};
  o.existence = 0.9;
  o.position = {x, 0, 0};
  return o;
}

// Scenes 0.1 s apart with these objects.
TrackedRun runOf(std::vector<std::vector<SceneObject>> scenes) {
  TrackedRun run;
  run.class_names = {"pedestrian", "car", "static-other"};
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    Scene scene;
    scene.frame = static_cast<std::int64_t>(k);
    scene.stamp = Stamp::fromSeconds(0.1 * static_cast<double>(k));
    scene.objects = scenes[k];
    run.scenes.push_back(scene);
  }
  return run;
}

TEST(CountObjects, OnlyRoadUsersAreClassified) {
  const CountedRun counted = countObjects(
      runOf({{object(1, 5, 1, true), object(2, 9, 2, true), object(3, 12, 0, false)}, {}}), nullptr,
      {});
  EXPECT_EQ(counted.all, (std::vector<int>{3, 0}));
  EXPECT_EQ(counted.classified, (std::vector<int>{1, 0}));
  EvaluationOptions near;
  near.selection.range = 10;
  EXPECT_EQ(
      countObjects(runOf({{object(1, 5, 1, true), object(3, 12, 0, false)}}), nullptr, near).all,
      std::vector<int>{1});
  EXPECT_DOUBLE_EQ(counted.mean_cars, 0.5);
  EXPECT_FALSE(counted.evaluation);
}

TEST(CompareCounts, ErrorsAreOfEveryScene) {
  CountedRun run, reference;
  run.all = {4, 2, 3}, reference.all = {4, 4, 2};
  run.classified = reference.classified = {1, 1, 1};
  const CountErrors e = compareCounts(run, reference);
  EXPECT_NEAR(e.all, std::sqrt(5.0 / 3), 1e-12);
  EXPECT_EQ(e.classified, 0);
  EXPECT_NEAR(e.cdf_all[0], 1.0 / 3, 1e-12);
  EXPECT_NEAR(e.cdf_all[1], 2.0 / 3, 1e-12);
  EXPECT_EQ(e.cdf_all[2], 1);
  EXPECT_FALSE(e.truth);
}

TEST(CompareCounts, AgainstTheTruthStandsWhatCountsOnBothSides) {
  GroundTruth truth;
  GroundTruth::Instant instant;
  instant.frame = 0;
  TruthObject car;
  car.frame = 0;
  car.id = 1;
  car.type = "Car";
  car.position = {5, 0, 0};
  instant.objects = {car};
  truth.instants = {instant};
  const auto counted = countObjects(
      runOf({{object(1, 5, 1, true), object(2, 15, 1, true), object(3, 12, 2, true)}}), &truth, {});
  const CountErrors e = compareCounts(counted, counted);
  ASSERT_TRUE(e.truth);
  EXPECT_DOUBLE_EQ(*e.truth, 1);
  EXPECT_DOUBLE_EQ(*e.truth_bias, 1);
  EXPECT_DOUBLE_EQ(*e.unheld, 0);
}

TEST(CountObjects, APoleIsHeldByAnOutputOfAnyClass) {
  GroundTruth truth;
  GroundTruth::Instant instant;
  instant.frame = 0;
  TruthObject pole;
  pole.frame = 0;
  pole.type = "Misc";
  pole.ignore = true;
  for (const double x : {5.0, 10.0, 15.0}) {
    pole.position = {x, 0, x > 12 ? 3.0 : 0.0};  // the last one hangs above the road
    instant.objects.push_back(pole);
  }
  truth.instants = {instant};
  const auto counted = countObjects(runOf({{object(1, 5, 0, true)}}), &truth, {});
  EXPECT_EQ(counted.things, std::vector<int>{2});
  EXPECT_EQ(counted.held, std::vector<int>{1});
}

}  // namespace
}  // namespace perception
