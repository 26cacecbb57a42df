#include "libperception/filter/associate/Association.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace perception {
namespace {

/// One measurement that may be of either of two tracks or new: weights 3, 2 and 1, so that the
/// causes have probabilities 1/2, 1/3 and 1/6; and a second one that prefers the first track.
struct TwoTracks {
  std::vector<Track> tracks{2};
  LikelihoodTable table;
  FilterModel model;

  TwoTracks() {
    table.tracks.resize(2);
    table.births.resize(2);
    for (auto& birth : table.births) birth.log_new = 0;
    for (std::size_t t = 0; t < 2; ++t) {
      tracks[t].existence = 0.5;
      table.tracks[t].seen = 0.8;
      add(t, 0, t == 0 ? 3 : 2);
    }
    add(0, 1, 4);
  }

  /// Makes the odds of track t and a newborn for measurement m `odds`.
  void add(std::size_t t, std::size_t m, double odds) {
    PairLikelihood pair;
    pair.measurement = m;
    pair.log_likelihood = std::log(odds) - std::log(0.5) + std::log1p(-0.5 * 0.8);
    table.tracks[t].pairs.push_back(pair);
  }

  std::vector<SampledAssociation> sample(std::uint32_t slots, std::uint64_t counter) const {
    std::vector<std::uint32_t> all(slots);
    std::iota(all.begin(), all.end(), 0u);
    return sampleAssociations({0, 1}, AssociationIndex(tracks, table, model), {0, 1}, all,
                              {1, counter, 0, 0});
  }
};

double shareOf(const std::map<std::vector<int>, double>& counts, const std::vector<int>& causes) {
  double all = 0;
  for (const auto& [cause, count] : counts) all += count;
  return counts.count(causes) ? counts.at(causes) / all : 0;
}

constexpr int kNew = Association::kNew;

TEST(Association, EverySlotDrawsTheCausesWithTheirProbabilities) {
  const TwoTracks tracks;
  constexpr std::uint32_t kSlots = 5;
  constexpr int kScans = 20000;
  std::vector<std::map<std::vector<int>, double>> counts(kSlots);
  for (int scan = 0; scan < kScans; ++scan)
    for (const auto& sampled : tracks.sample(kSlots, static_cast<std::uint64_t>(scan)))
      for (const std::uint32_t slot : sampled.slots) ++counts[slot][sampled.association.cause];
  for (const auto& of_slot : counts) {
    EXPECT_NEAR(shareOf(of_slot, {0, kNew}), 1.0 / 2, 0.015);
    EXPECT_NEAR(shareOf(of_slot, {1, 0}), 1.0 / 3 * 4 / 5, 0.015);
    EXPECT_NEAR(shareOf(of_slot, {1, kNew}), 1.0 / 3 * 1 / 5, 0.015);
    EXPECT_NEAR(shareOf(of_slot, {kNew, 0}), 1.0 / 6 * 4 / 5, 0.015);
    EXPECT_NEAR(shareOf(of_slot, {kNew, kNew}), 1.0 / 6 * 1 / 5, 0.015);
  }
}

TEST(Association, CausesGetTheirSharesOfTheSlotsButForOne) {
  const TwoTracks tracks;
  for (std::uint64_t scan = 0; scan < 100; ++scan) {
    std::map<int, double> slots;
    for (const auto& sampled : tracks.sample(600, scan))
      slots[sampled.association.cause[0]] += static_cast<double>(sampled.slots.size());
    EXPECT_NEAR(slots[0], 300, 1);
    EXPECT_NEAR(slots[1], 200, 1);
    EXPECT_NEAR(slots[kNew], 100, 1);
  }
}

TEST(Association, TheWeightIsThatOfAllCausesTogether) {
  const TwoTracks tracks;
  const double missed = 2 * std::log1p(-0.5 * 0.8);
  for (const auto& sampled : tracks.sample(100, 0)) {
    const bool taken = sampled.association.cause[0] == 0;
    EXPECT_NEAR(sampled.association.log_weight,
                missed + std::log(6.0) + (taken ? 0 : std::log(5.0)), 1e-12);
  }
}

TEST(Association, SlotsStayAscendingAndEachIsSampledOnce) {
  const TwoTracks tracks;
  std::vector<int> seen(1000, 0);
  for (const auto& sampled : tracks.sample(1000, 3)) {
    EXPECT_TRUE(std::is_sorted(sampled.slots.begin(), sampled.slots.end()));
    for (const std::uint32_t slot : sampled.slots) ++seen[slot];
  }
  for (const int times : seen) EXPECT_EQ(times, 1);
}

}  // namespace
}  // namespace perception
