#include "libperception/filter/associate/RankedChildren.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

/// A scan of random pairs and hypotheses that share most of their tracks.
struct Scene {
  static constexpr std::size_t kTracks = 14, kMeasurements = 7, kHypotheses = 9;
  std::vector<Track> tracks{kTracks};
  LikelihoodTable table;
  FilterModel model;
  std::vector<TrackIndices> hypotheses;
  std::vector<double> log_weights;

  explicit Scene(std::uint64_t seed) {
    Rng rng({seed, 0, 0, 0});
    table.tracks.resize(kTracks);
    table.births.resize(kMeasurements);
    for (auto& n : table.births) n.log_new = rng.normal(-3, 1);
    for (std::size_t t = 0; t < kTracks; ++t) {
      tracks[t].existence = rng.uniform(0.1, 0.99);
      table.tracks[t].seen = rng.uniform(0.2, 0.9);
      for (std::size_t m = 0; m < kMeasurements; ++m) {
        if (rng.uniform() > 0.2) continue;
        PairLikelihood pair;
        pair.measurement = m;
        pair.log_likelihood = rng.normal(0, 3);
        table.tracks[t].pairs.push_back(pair);
      }
    }
    for (std::size_t h = 0; h < kHypotheses; ++h) {
      auto& own = hypotheses.emplace_back();
      for (std::uint32_t t = 0; t < kTracks; t += 2) own.push_back(rng.uniform() < 0.8 ? t : t + 1);
      log_weights.push_back(rng.normal(0, 2));
    }
  }

  /// Log weight of an association by its definition.
  double weightOf(std::size_t h, const std::vector<int>& cause) const {
    double sum = log_weights[h];
    for (const std::uint32_t t : hypotheses[h]) {
      const double r = tracks[t].existence;
      const auto m = std::find(cause.begin(), cause.end(), static_cast<int>(t));
      if (m == cause.end()) {
        sum += std::log1p(-r * table.tracks[t].seen);
        continue;
      }
      for (const auto& pair : table.tracks[t].pairs)
        if (pair.measurement == static_cast<std::size_t>(m - cause.begin()))
          sum += std::log(r) + pair.log_likelihood;
    }
    for (std::size_t m = 0; m < cause.size(); ++m)
      if (cause[m] == Association::kNew) sum += table.births[m].log_new;
    return sum;
  }

  /// The likeliest children, each hypothesis ranked alone and without bounds.
  std::vector<double> bruteForce(std::size_t children, std::size_t slots) const {
    std::vector<double> out;
    for (std::size_t h = 0; h < kHypotheses; ++h) {
      std::vector<double> own;
      std::vector<int> cause(kMeasurements, Association::kNew);
      fill(h, 0, cause, own);
      std::sort(own.rbegin(), own.rend());
      own.resize(std::min(own.size(), children));
      out.insert(out.end(), own.begin(), own.end());
    }
    std::sort(out.rbegin(), out.rend());
    out.resize(std::min(out.size(), slots));
    return out;
  }

 private:
  void fill(std::size_t h, std::size_t m, std::vector<int>& cause, std::vector<double>& out) const {
    if (m == cause.size()) {
      out.push_back(weightOf(h, cause));
      return;
    }
    fill(h, m + 1, cause, out);
    for (const std::uint32_t t : hypotheses[h]) {
      const auto& pairs = table.tracks[t].pairs;
      const bool near = std::any_of(pairs.begin(), pairs.end(),
                                    [&](const auto& pair) { return pair.measurement == m; });
      const int column = static_cast<int>(t);
      if (!near || std::find(cause.begin(), cause.end(), column) != cause.end()) continue;
      cause[m] = column;
      fill(h, m + 1, cause, out);
      cause[m] = Association::kNew;
    }
  }
};

TEST(RankedChildren, AreTheLikeliestOfAllHypothesesWithTheirExactWeights) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Scene scene(seed);
    const AssociationIndex index(scene.tracks, scene.table, scene.model);
    for (const std::size_t slots : {1u, 5u, 30u, 1000u}) {
      for (const std::size_t children : {1u, 4u, 50u}) {
        const auto truth = scene.bruteForce(children, slots);
        const auto ranked =
            rankChildren(scene.hypotheses, scene.log_weights, index, {children, slots, 1e9});
        ASSERT_EQ(ranked.size(), truth.size()) << seed;
        for (std::size_t i = 0; i < truth.size(); ++i) {
          ASSERT_NEAR(ranked[i].log_weight, truth[i], 1e-10) << seed;
          ASSERT_NEAR(scene.weightOf(ranked[i].parent, ranked[i].association.cause), truth[i],
                      1e-10);
        }
      }
    }
  }
}

TEST(RankedChildren, EndWhereTheyAreLighterThanTheBestByTheSpan) {
  const Scene scene(3);
  const AssociationIndex index(scene.tracks, scene.table, scene.model);
  const auto truth = scene.bruteForce(1000, 100000);
  const auto expected =
      std::count_if(truth.begin(), truth.end(), [&](double w) { return w >= truth.front() - 4; });
  EXPECT_EQ(rankChildren(scene.hypotheses, scene.log_weights, index, {1000, 100000, 4}).size(),
            static_cast<std::size_t>(expected));
}

}  // namespace
}  // namespace perception
