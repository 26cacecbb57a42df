#include "studies/association/EncounterRuns.h"

#include <gtest/gtest.h>

#include <cmath>

#include "studies/association/AssociationStudy.h"

namespace perception {
namespace {

AssociationScene sceneOf(const std::string& label) {
  for (const auto& s : associationScenes())
    if (s.label == label) return s;
  return {};
}

TEST(Encounters, ACrowdNeedsMoreThanOneParticle) {
  const auto one = runAssociation(sceneOf("D hard"), {"", Proposal::kSampled, 1}, 100);
  const auto eight = runAssociation(sceneOf("D hard"), {"", Proposal::kSampled, 8}, 100);
  // One-sided two-proportion test at 1 %: the difference is no chance.
  const double a = one.swaps / 100.0, b = eight.swaps / 100.0, pooled = (a + b) / 2;
  EXPECT_GT((a - b) / std::sqrt(2 * pooled * (1 - pooled) / 100), 2.326) << a << " against " << b;
  EXPECT_LT(wilsonUpper(eight.swaps, 100), 0.12);
  EXPECT_GT(eight.tracked, 0.9);
}

TEST(Encounters, EightRankedHypothesesKeepIdentitiesApart) {
  // 100 of the study's 400 seeds; the bounds are those of a Python prototype with the wider
  // interval.
  EXPECT_LT(
      wilsonUpper(runAssociation(sceneOf("E0.8_1.5"), {"", Proposal::kRanked, 8}, 100).swaps, 100),
      0.08);
  EXPECT_LT(
      wilsonUpper(runAssociation(sceneOf("E0.6_0.5"), {"", Proposal::kRanked, 8}, 100).swaps, 100),
      0.20);
  const auto crossing = runAssociation(sceneOf("C0.5 hard"), {"", Proposal::kRanked, 8}, 100);
  EXPECT_LT(crossing.gospa, 0.42);
  EXPECT_EQ(crossing.swaps, 0);
}

TEST(Encounters, OpenScenesAreTrackedThroughout) {
  for (const char* name : {"A", "B", "C1.0"}) {
    double tracked = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      tracked +=
          runEncounter(name, {}, associationModel(Proposal::kSampled), 8, seed, seed).tracked / 20;
    }
    EXPECT_GT(tracked, 0.98) << name;
  }
}

TEST(Encounters, AreRepeatedToTheBit) {
  const auto model = associationModel(Proposal::kSampled);
  const auto a = runEncounter("D", {0.75, 3, 1, 0.7}, model, 8, 3, 5);
  const auto b = runEncounter("D", {0.75, 3, 1, 0.7}, model, 8, 3, 5);
  EXPECT_EQ(a.gospa, b.gospa);
  EXPECT_EQ(a.count, b.count);
}

TEST(WilsonUpper, IsTheBoundOfTheBook) {
  // 10 of 100: [brown2001] gives (.055, .174).
  EXPECT_NEAR(wilsonUpper(10, 100), 0.1744, 5e-4);
  EXPECT_NEAR(wilsonUpper(0, 100), 0.0370, 5e-4);
}

}  // namespace
}  // namespace perception
