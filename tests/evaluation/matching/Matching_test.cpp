#include "libperception/evaluation/matching/Matching.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <random>

namespace perception {
namespace {

TEST(Matching, ClosestLetsOneEstimateServeTwoTruths) {
  const std::vector<Vector2> truth = {{0, 0}, {1, 0}}, estimates = {{0.6, 0}};
  EXPECT_EQ(match(truth, estimates, 2, Pairing::kClosest), (std::vector<int>{0, 0}));
  EXPECT_EQ(match(truth, estimates, 2, Pairing::kOneToOne), (std::vector<int>{-1, 0}));
}

TEST(Matching, OneToOnePrefersMorePairsToAShorterOne) {
  // Greedily the pair (1, 0) at 0.1 m would leave truth 0 alone.
  const std::vector<Vector2> truth = {{0, 0}, {1, 0}}, estimates = {{1.1, 0}, {2.5, 0}};
  EXPECT_EQ(match(truth, estimates, 2, Pairing::kOneToOne), (std::vector<int>{0, 1}));
  EXPECT_EQ(match(truth, estimates, 2, Pairing::kClosest), (std::vector<int>{0, 0}));
}

TEST(Matching, ThePairMayBeAsFarApartAsTheToleranceAndNoFarther) {
  for (const Pairing p : {Pairing::kClosest, Pairing::kOneToOne}) {
    EXPECT_EQ(match({{0, 0}}, {{2, 0}}, 2, p), std::vector<int>{0});
    EXPECT_EQ(match({{0, 0}}, {{2.001, 0}}, 2, p), std::vector<int>{-1});
    EXPECT_EQ(match({{0, 0}}, {}, 2, p), std::vector<int>{-1});
    EXPECT_TRUE(match({}, {{0, 0}}, 2, p).empty());
  }
}

TEST(Matching, ATruthWithoutAPlaceMatchesNothing) {
  const double none = std::numeric_limits<double>::quiet_NaN();  // KITTI's DontCare
  for (const Pairing p : {Pairing::kClosest, Pairing::kOneToOne}) {
    EXPECT_EQ(match({{none, none}}, {{2, 0}}, 2, p), std::vector<int>{-1});
    EXPECT_EQ(match({{none, none}, {9, 0}}, {{2, 0}, {9, 0}}, 2, p), (std::vector<int>{-1, 1}));
  }
}

TEST(Matching, OneToOneEqualsExhaustiveSearch) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0, 4);
  const auto draw = [&](std::size_t n) {
    std::vector<Vector2> points(n);
    for (Vector2& p : points) p = {uniform(random), uniform(random)};
    return points;
  };
  for (std::size_t trial = 0; trial < 200; ++trial) {
    const auto truth = draw(1 + trial % 4), estimates = draw(1 + trial % 5);
    // (pairs, -distance), lexicographically the greatest.
    std::pair<int, double> best{0, 0};
    std::vector<bool> used(estimates.size(), false);
    const std::function<void(std::size_t, int, double)> search = [&](std::size_t r, int pairs,
                                                                     double sum) {
      best = std::max(best, {pairs, -sum});
      if (r == truth.size()) return;
      search(r + 1, pairs, sum);
      for (std::size_t c = 0; c < estimates.size(); ++c) {
        const double d = (truth[r] - estimates[c]).norm();
        if (used[c] || d > 2) continue;
        used[c] = true;
        search(r + 1, pairs + 1, sum + d);
        used[c] = false;
      }
    };
    search(0, 0, 0);
    std::pair<int, double> found{0, 0};
    const auto result = match(truth, estimates, 2, Pairing::kOneToOne);
    for (std::size_t r = 0; r < result.size(); ++r) {
      if (result[r] < 0) continue;
      ++found.first;
      found.second -= (truth[r] - estimates[static_cast<std::size_t>(result[r])]).norm();
    }
    EXPECT_EQ(found.first, best.first);
    EXPECT_NEAR(found.second, best.second, 1e-9);
  }
}

}  // namespace
}  // namespace perception
