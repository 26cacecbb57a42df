#include "studies/association/EncounterRuns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "libperception/core/math/Assignment.h"
#include "libperception/evaluation/metrics/ShareInterval.h"
#include "tests/studies/association/NamedEncounters.h"

namespace perception {
namespace {

constexpr int kRuns = 100;
const EncounterConditions kHard{0.75, 3, 1, 0.7};

constexpr double kCutoff = 2;        // [m]
constexpr std::size_t kWarmUp = 10;  // instants: 1 s

/// By truth object the id of the estimate that is assigned to it within the cut-off; 0: none.
std::vector<std::uint64_t> matchIds(const std::vector<Vector2>& truth, const Scene& scene) {
  std::vector<std::uint64_t> ids(truth.size(), 0);
  const std::size_t n = scene.objects.size();
  if (truth.empty() || n == 0) return ids;
  Eigen::MatrixXd cost(truth.size(), n);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = std::min(
          kCutoff * kCutoff, (truth[i] - scene.objects[j].position.head<2>()).squaredNorm());
    }
  }
  const auto columns = optimalAssignment(cost);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const int j = columns[i];
    if (j >= 0 && cost(static_cast<Eigen::Index>(i), j) < kCutoff * kCutoff)
      ids[i] = scene.objects[static_cast<std::size_t>(j)].id;
  }
  return ids;
}

std::uint64_t dominant(const std::vector<std::uint64_t>& ids) {
  std::map<std::uint64_t, int> count;
  for (const auto id : ids) ++count[id];
  return std::max_element(count.begin(), count.end(),
                          [](auto& a, auto& b) { return a.second < b.second; })
      ->first;
}

/// Whether a run keeps objects and their identities, from the second second on.
class Identities {
 public:
  explicit Identities(const EncounterScene& scene)
      : scene_(scene), before_(scene.objects.size()), after_(scene.objects.size()) {}

  void add(std::size_t k, const Scene& estimate) {
    if (k < kWarmUp) return;
    std::vector<Vector2> truth;
    std::vector<std::size_t> who;
    for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
      if (!encounterInView(scene_.objects[i].path[k])) continue;
      truth.push_back(scene_.objects[i].path[k]);
      who.push_back(i);
    }
    const auto ids = matchIds(truth, estimate);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      ++instants_;
      if (ids[i] == 0) continue;
      ++tracked_;
      if (3 * k < scene_.instants()) before_[who[i]].push_back(ids[i]);
      if (10 * k >= 6 * scene_.instants()) after_[who[i]].push_back(ids[i]);
    }
  }

  /// Whether the dominant id of some object differs in the first third and in the last four tenths.
  bool swapped() const {
    for (std::size_t i = 0; i < before_.size(); ++i) {
      if (before_[i].empty() || after_[i].empty()) continue;
      if (dominant(before_[i]) != dominant(after_[i])) return true;
    }
    return false;
  }
  /// Share of (object, instant) with an estimate within 2 m.
  double tracked() const { return tracked_ / std::max(1.0, instants_); }

 private:
  const EncounterScene& scene_;
  std::vector<std::vector<std::uint64_t>> before_, after_;
  double tracked_ = 0, instants_ = 0;
};

struct SeenEncounter {
  EncounterScore score;
  bool swapped = false;
  double tracked = 0;
};

SeenEncounter seenEncounter(const std::string& name, const EncounterConditions& conditions,
                            const FilterModel& model, int particles, std::uint64_t seed,
                            std::uint64_t filter_seed) {
  Rng world({seed, 0, 0, 1});
  const EncounterScene scene = test::encounterScene(name, world);
  Identities identities(scene);
  const EncounterScore score =
      runEncounter(scene, conditions, model, particles, seed, filter_seed,
                   [&](std::size_t k, const Scene& estimate) { identities.add(k, estimate); });
  return {score, identities.swapped(), identities.tracked()};
}

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
    const SeenEncounter run = seenEncounter(scene, conditions, model, particles, seed, seed);
    f.swaps += run.swapped;
    f.gospa += run.score.gospa / kRuns;
    f.tracked += run.tracked / kRuns;
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
          seenEncounter(name, {}, encounterModel(Proposal::kSampled), 8, seed, seed).tracked / 20;
    }
    EXPECT_GT(tracked, 0.98) << name;
  }
}

TEST(Encounters, AreRepeatedToTheBit) {
  const auto model = encounterModel(Proposal::kSampled);
  const auto a = seenEncounter("D", kHard, model, 8, 3, 5).score;
  const auto b = seenEncounter("D", kHard, model, 8, 3, 5).score;
  EXPECT_EQ(a.gospa, b.gospa);
  EXPECT_EQ(a.count, b.count);
}

}  // namespace
}  // namespace perception
