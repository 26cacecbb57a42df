#include "libperception/evaluation/without_truth/RunDifference.h"

#include <gtest/gtest.h>

#include "tests/evaluation/MakeRun.h"

namespace perception {
namespace {

using namespace testing_evaluation;
using Other = ComparedIdentity::Other;

// Car 1 drives along x and pedestrian 2 stands 20 m beside it, for 20 instants.
TrackedRun twoObjects() {
  TrackedRun run = makeRun();
  for (std::int64_t k = 0; k < 20; ++k) {
    const double x = static_cast<double>(k);
    run.scenes.push_back(makeScene(k, {makeObject(1, x, 0), makeObject(2, 0, 20, kPedestrian)}));
  }
  return run;
}

TEST(RunDifference, IdenticalRunsHaveNone) {
  const RunDifference d = compareRuns(twoObjects(), twoObjects());
  EXPECT_TRUE(d.none());
  EXPECT_TRUE(d.rows.empty());
  EXPECT_EQ(d.common, 20u);
  EXPECT_EQ(d.pairs, 2u);
  EXPECT_EQ(d.a.objects, 40u);
  EXPECT_EQ(d.a.sure, 40u);
  EXPECT_EQ(d.a.identities, 2u);
  EXPECT_EQ(d.a.objectsPerInstant(), 2);
}

TEST(RunDifference, ObjectsAtTheSamePlaceAreNoDifferenceAndOtherNumbersNeither) {
  TrackedRun a = makeRun(), b = makeRun();
  for (std::int64_t k = 0; k < 5; ++k) {
    a.scenes.push_back(makeScene(k, {makeObject(1, 3, 0), makeObject(2, 3, 0)}));
    b.scenes.push_back(makeScene(k, {makeObject(4, 3, 0), makeObject(7, 3, 0)}));
  }
  EXPECT_TRUE(compareRuns(a, a).none());
  EXPECT_TRUE(compareRuns(b, b).none());
  EXPECT_TRUE(compareRuns(a, b).none());
}

TEST(RunDifference, AnIdSplitInBIsOneSwitch) {
  TrackedRun b = twoObjects();
  for (std::size_t k = 12; k < 20; ++k) b.scenes[k].objects[0].id = 9;
  const RunDifference d = compareRuns(twoObjects(), b);
  ASSERT_EQ(d.rows.size(), 2u);
  const IdentityDifference &pair = d.rows[0], &rest = d.rows[1];
  ASSERT_TRUE(pair.a && pair.b);
  EXPECT_EQ(pair.a->id, 1u);
  EXPECT_EQ(pair.b->id, 1u) << "the one with most instants in common";
  EXPECT_EQ(pair.together, 12u);
  EXPECT_EQ(pair.apart, 8u);
  EXPECT_EQ(pair.a->switches, 1u);
  EXPECT_EQ(pair.b->switches, 0u);
  EXPECT_EQ(pair.a->matched.at(9), 8u);
  EXPECT_FALSE(rest.a);
  EXPECT_EQ(rest.b->id, 9u);
  EXPECT_EQ(rest.b->matched.at(1), 8u);
  ASSERT_EQ(rest.b->stretches.size(), 1u);
  EXPECT_EQ(rest.b->stretches[0].other, Other::kMatched);
}

TEST(RunDifference, AnotherClassIsCountedByInstant) {
  TrackedRun b = twoObjects();
  b.class_names = {"car", "pedestrian", "static-other"};  // by name, not by place
  for (std::size_t k = 0; k < 20; ++k) {
    b.scenes[k].objects[0] = makeObject(1, static_cast<double>(k), 0, k < 15 ? 0 : 2);
    b.scenes[k].objects[1] = makeObject(2, 0, 20, 1);
  }
  const RunDifference d = compareRuns(twoObjects(), b);
  ASSERT_EQ(d.rows.size(), 1u);
  const IdentityDifference& row = d.rows[0];
  EXPECT_EQ(row.together, 20u);
  EXPECT_EQ(row.classes_apart, 5u);
  EXPECT_EQ(row.apart, 5u);
  EXPECT_EQ(row.values_apart, 5u);
  EXPECT_EQ(row.distance_rms, 0);
  EXPECT_EQ(d.classes[row.a->last_class], "car");
  EXPECT_EQ(d.classes[row.b->last_class], "static-other");
  EXPECT_EQ(row.b->class_instants, (std::vector<std::size_t>{0, 15, 5}));
  EXPECT_NEAR(row.b->last_probability, .98, 1e-12);
  EXPECT_EQ(row.b->stretches.size(), 2u);
}

TEST(RunDifference, AnObjectOnlyInAIsARowAlone) {
  TrackedRun b = twoObjects();
  for (Scene& scene : b.scenes) scene.objects.pop_back();
  const RunDifference d = compareRuns(twoObjects(), b);
  ASSERT_EQ(d.rows.size(), 1u);
  const IdentityDifference& row = d.rows[0];
  EXPECT_FALSE(row.b);
  EXPECT_EQ(row.a->id, 2u);
  EXPECT_EQ(row.apart, 20u);
  EXPECT_TRUE(row.a->matched.empty());
  EXPECT_EQ(row.a->stretches[0].other, Other::kNone);
  EXPECT_NEAR(row.a->first, 0, 1e-9);
  EXPECT_NEAR(row.a->last, 1.9, 1e-9);
}

TEST(RunDifference, OnlyObjectsInReachAreTheSame) {
  TrackedRun near = twoObjects(), far = twoObjects();
  for (std::size_t k = 0; k < 20; ++k) {
    near.scenes[k].objects[1].position.x() += 1.5;
    far.scenes[k].objects[1].position.x() += 2.1;
  }
  const RunDifference within = compareRuns(twoObjects(), near);
  ASSERT_EQ(within.rows.size(), 1u);
  EXPECT_NEAR(within.rows[0].distance_rms, 1.5, 1e-12);
  EXPECT_EQ(within.rows[0].apart, 0u);
  const RunDifference beyond = compareRuns(twoObjects(), far);
  ASSERT_EQ(beyond.rows.size(), 2u);
  EXPECT_TRUE(beyond.rows[0].a && !beyond.rows[0].b);
  EXPECT_TRUE(beyond.rows[1].b && !beyond.rows[1].a);
}

TEST(RunDifference, AnExactMatchIsNotGivenUpForAFurtherPair) {
  TrackedRun a = makeRun(), b = makeRun();
  a.scenes.push_back(makeScene(0, {makeObject(1, 0, 0), makeObject(2, 1.9, 0)}));
  b.scenes.push_back(makeScene(0, {makeObject(1, 0, 0), makeObject(2, -1.9, 0)}));
  const RunDifference d = compareRuns(a, b);
  EXPECT_EQ(d.pairs, 1u);
  EXPECT_EQ(d.rows.size(), 2u);
}

TEST(RunDifference, RowsThatDifferMostComeFirst) {
  TrackedRun b = twoObjects();
  for (std::size_t k = 0; k < 3; ++k)
    b.scenes[k].objects[0] = makeObject(1, static_cast<double>(k), 0, kStaticOther);
  for (std::size_t k = 5; k < 20; ++k) b.scenes[k].objects.pop_back();
  const RunDifference d = compareRuns(twoObjects(), b);
  ASSERT_EQ(d.rows.size(), 2u);
  EXPECT_EQ(d.rows[0].a->id, 2u);
  EXPECT_EQ(d.rows[0].apart, 15u);
  EXPECT_EQ(d.rows[1].apart, 3u);
  ASSERT_EQ(d.rows[0].a->stretches.size(), 2u);
  EXPECT_EQ(d.rows[0].a->stretches[1].other, Other::kNone);
}

TEST(RunDifference, AnyOtherValueIsADifference) {
  TrackedRun b = twoObjects();
  b.scenes[7].objects[0].sd_yaw += 1e-3;
  const RunDifference d = compareRuns(twoObjects(), b);
  ASSERT_EQ(d.rows.size(), 1u);
  EXPECT_EQ(d.rows[0].values_apart, 1u);
  EXPECT_EQ(d.rows[0].apart, 0u);
  b = twoObjects();
  b.scenes[7].ego.yaw_rate += 1e-3;
  EXPECT_EQ(compareRuns(twoObjects(), b).ego_apart, 1u);
  EXPECT_FALSE(compareRuns(twoObjects(), b).none());
  b = twoObjects();
  b.scenes[7].path = FreePath{};
  EXPECT_EQ(compareRuns(twoObjects(), b).path_apart, 1u);
}

TEST(RunDifference, ScenesAreThoseOfTheNearestInstant) {
  TrackedRun b = makeRun();  // twice as often, 10 ms later, the car moved on
  for (std::int64_t k = 0; k < 40; ++k) {
    b.scenes.push_back(makeScene(k, {makeObject(5, 0.5 * static_cast<double>(k) + 0.1, 0)}));
    b.scenes.back().stamp = Stamp::fromSeconds(1000.01 + 0.05 * static_cast<double>(k));
    b.scenes.back().objects[0].velocity = {10, 0};
  }
  const RunDifference d = compareRuns(twoObjects(), b);
  EXPECT_EQ(d.common, 20u);
  EXPECT_EQ(d.shifted, 20u);
  EXPECT_EQ(d.only_a, 0u);
  EXPECT_EQ(d.only_b, 20u);
  ASSERT_EQ(d.rows.size(), 2u);
  EXPECT_EQ(d.rows[1].together, 20u);
  EXPECT_NEAR(d.rows[1].distance_rms, 0, 1e-6) << "moved to the instant of A";
  EXPECT_EQ(d.rows[1].b->instants, 40u);
  EXPECT_EQ(d.rows[1].b->stretches.size(), 2u) << "one to the last common instant, one behind it";
}

TEST(RunDifference, AShorterRunLeavesInstantsWithoutComparison) {
  TrackedRun b = twoObjects();
  b.scenes.resize(5);
  const RunDifference d = compareRuns(twoObjects(), b);
  EXPECT_TRUE(d.rows.empty()) << "all that can be compared is the same";
  EXPECT_FALSE(d.none());
  EXPECT_EQ(d.only_a, 15u);
  EXPECT_EQ(compareRuns(twoObjects(), makeRun()).rows.size(), 2u);
  EXPECT_TRUE(compareRuns(makeRun(), makeRun()).none());
}

}  // namespace
}  // namespace perception
