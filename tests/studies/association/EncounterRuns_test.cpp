#include "studies/association/EncounterRuns.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/evaluation/metrics/ShareInterval.h"

namespace perception {
namespace {

constexpr int kRuns = 100;
const EncounterConditions kHard{0.75, 3, 1, 0.7};

/// Of kRuns runs with the seeds 1, 2, ...
struct Figures {
  int swaps = 0;
  double gospa = 0, tracked = 0;  // means
  /// Upper bound of the two-sided 95 % interval of the share of runs with a swap.
  double mostSwaps() const {
    return wilsonInterval(static_cast<double>(swaps) / kRuns, kRuns).high;
  }
};

Figures figuresOf(const std::string& scene, const EncounterConditions& conditions,
                  Proposal proposal, int particles) {
  const FilterModel model = encounterModel(proposal);
  Figures f;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    const EncounterScore score = runEncounter(scene, conditions, model, particles, seed, seed);
    f.swaps += score.swapped;
    f.gospa += score.gospa / kRuns;
    f.tracked += score.tracked / kRuns;
  }
  return f;
}

TEST(Encounters, ACrowdNeedsMoreThanOneParticle) {
  const auto one = figuresOf("D", kHard, Proposal::kSampled, 1);
  const auto eight = figuresOf("D", kHard, Proposal::kSampled, 8);
  // One-sided two-proportion test at 1 %: the difference is no chance.
  const double a = one.swaps / 100.0, b = eight.swaps / 100.0, pooled = (a + b) / 2;
  EXPECT_GT((a - b) / std::sqrt(2 * pooled * (1 - pooled) / 100), 2.326) << a << " against " << b;
  EXPECT_LT(eight.mostSwaps(), 0.12);
  EXPECT_GT(eight.tracked, 0.9);
}

TEST(Encounters, EightRankedHypothesesKeepIdentitiesApart) {
  // The bounds are those of a Python prototype with the wider interval.
  EXPECT_LT(figuresOf("E0.8_1.5", {}, Proposal::kRanked, 8).mostSwaps(), 0.08);
  EXPECT_LT(figuresOf("E0.6_0.5", {}, Proposal::kRanked, 8).mostSwaps(), 0.20);
  const auto crossing = figuresOf("C0.5", kHard, Proposal::kRanked, 8);
  EXPECT_LT(crossing.gospa, 0.42);
  EXPECT_EQ(crossing.swaps, 0);
}

TEST(Encounters, OpenScenesAreTrackedThroughout) {
  for (const char* name : {"A", "B", "C1.0"}) {
    double tracked = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      tracked +=
          runEncounter(name, {}, encounterModel(Proposal::kSampled), 8, seed, seed).tracked / 20;
    }
    EXPECT_GT(tracked, 0.98) << name;
  }
}

TEST(Encounters, AreRepeatedToTheBit) {
  const auto model = encounterModel(Proposal::kSampled);
  const auto a = runEncounter("D", kHard, model, 8, 3, 5);
  const auto b = runEncounter("D", kHard, model, 8, 3, 5);
  EXPECT_EQ(a.gospa, b.gospa);
  EXPECT_EQ(a.count, b.count);
}

}  // namespace
}  // namespace perception
