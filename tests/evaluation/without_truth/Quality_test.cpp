#include "libperception/evaluation/without_truth/Quality.h"

#include <gtest/gtest.h>

#include "tests/evaluation/MakeRun.h"

namespace perception {
namespace {

using namespace testing_evaluation;

Figure figureOf(const Quality& quality, const std::string& name) {
  for (std::size_t k = 0; k < qualityKinds().size(); ++k)
    if (name == qualityKinds()[k].name) return quality.values.at(k);
  ADD_FAILURE() << "no figure " << name;
  return {};
}

/// Three seconds of a car at 10 m that drives along y at 2 m/s and is said to drive at `said`.
TrackedRun carThatSays(double said) {
  TrackedRun run = makeRun();
  for (int k = 0; k <= 30; ++k) {
    SceneObject car = makeObject(1, 10, 0.2 * k - 3);
    car.velocity = {0, said};
    run.scenes.push_back(makeScene(k, {car}));
  }
  return run;
}

TEST(Quality, AWrongVelocityIsSeenInTheMotion) {
  EXPECT_NEAR(*figureOf(qualityOf(carThatSays(2), {}, {}), "off_velocity"), 0, 1e-9);
  EXPECT_NEAR(*figureOf(qualityOf(carThatSays(5), {}, {}), "off_velocity"), 3, 1e-9);
}

TEST(Quality, PositionsThatJumpAreOffTheirCurve) {
  TrackedRun run = carThatSays(2);
  EXPECT_NEAR(*figureOf(qualityOf(run, {}, {}), "off_curve"), 0, 1e-9);
  for (std::size_t k = 0; k < run.scenes.size(); k += 2)
    run.scenes[k].objects[0].position.x() += 0.5;
  EXPECT_GT(*figureOf(qualityOf(run, {}, {}), "off_curve"), 0.15);
}

TEST(Quality, ATrackOfThreeScenesIsShortAndOneThatEndsWithTheLogIsNot) {
  TrackedRun run = carThatSays(2);
  for (const std::size_t k : {10U, 11U, 12U}) run.scenes[k].objects.push_back(makeObject(2, 5, 4));
  for (const std::size_t k : {29U, 30U}) run.scenes[k].objects.push_back(makeObject(3, 5, -4));
  const Quality quality = qualityOf(run, {}, {});
  EXPECT_NEAR(*figureOf(quality, "short"), 1.0 / 31, 1e-9);
  EXPECT_EQ(quality.objects, 3U);
  ASSERT_FALSE(quality.moments.empty());
  EXPECT_EQ(quality.moments[0].id, 2U);
  EXPECT_EQ(quality.moments[0].kind, QualityMoment::Kind::kShortLife);
  EXPECT_TRUE(quality.moments[0].place.isApprox(Vector2(5, 4)));
  EXPECT_NEAR(quality.moments[0].t, 1, 1e-9);
}

TEST(Quality, ATrackThatAnotherContinuesIsAHandover) {
  TrackedRun run = carThatSays(2);
  for (std::size_t k = 15; k < run.scenes.size(); ++k) run.scenes[k].objects[0].id = 7;
  const Quality quality = qualityOf(run, {}, {});
  EXPECT_GT(*figureOf(quality, "handovers"), 0);
  EXPECT_EQ(quality.moments.back().text(), "continues 1");
  EXPECT_EQ(*figureOf(qualityOf(carThatSays(2), {}, {}), "handovers"), 0);
}

TEST(Quality, OneKindOfSensorSaysNothingOfAgreement) {
  TrackedRun run = carThatSays(2);
  EXPECT_FALSE(figureOf(qualityOf(run, {}, {}), "alone"));
  for (Scene& scene : run.scenes) {
    scene.objects[0].last_hit[Modality::kLidar] = scene.stamp;
    scene.objects[0].last_hit[Modality::kCamera] = scene.stamp;
    SceneObject other = makeObject(2, 5, 4);
    other.last_hit[Modality::kLidar] = scene.stamp;
    scene.objects.push_back(other);
  }
  EXPECT_EQ(*figureOf(qualityOf(run, {}, {}), "alone"), 1);  // an instant
}

TEST(Quality, AnotherSeedTellsWhatIsNotCertain) {
  TrackedRun run = carThatSays(2), other = carThatSays(2);
  for (Scene& scene : run.scenes) scene.objects.push_back(makeObject(2, 5, 4));
  for (Scene& scene : other.scenes) scene.objects[0].position.x() += 0.3;
  const Quality quality = qualityOf(run, {&other}, {});
  EXPECT_EQ(*figureOf(quality, "seeds_alone"), 1);
  EXPECT_NEAR(*figureOf(quality, "seeds_apart"), 0.3, 1e-9);
  EXPECT_FALSE(figureOf(qualityOf(run, {}, {}), "seeds_alone"));
}

TEST(Quality, OnlyNamedClassesInTheSectorCount) {
  TrackedRun run = makeRun();
  run.scenes.push_back(makeScene(
      0, {makeObject(1, 10, 0), makeObject(2, 10, 3, kStaticOther), makeObject(3, 50, 0)}));
  EXPECT_EQ(qualityOf(run, {}, {}).objects, 1U);
}

TEST(RankCorrelation, IsOneForEqualOrderAndMinusOneForTheOpposite) {
  EXPECT_NEAR(*rankCorrelation({1.0, 2.0, 3.0}, {10.0, 100.0, 1000.0}), 1, 1e-12);
  EXPECT_NEAR(*rankCorrelation({1.0, 2.0, 3.0}, {3.0, 2.0, 1.0}), -1, 1e-12);
  // Ties share their mean rank: ranks 0 1.5 1.5 3 against 0 1 2 3.
  EXPECT_NEAR(*rankCorrelation({1.0, 2.0, 2.0, 3.0}, {1.0, 2.0, 3.0, 4.0}), 0.9486833, 1e-6);
  EXPECT_FALSE(rankCorrelation({1.0, 1.0, 1.0}, {1.0, 2.0, 3.0}));
  EXPECT_FALSE(rankCorrelation({1.0, 2.0, {}}, {1.0, 2.0, 3.0}));
}

}  // namespace
}  // namespace perception
