#include "libperception/core/math/Random.h"

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "libperception/core/math/Chi2.h"

namespace perception {
namespace {

// A statistic that is chi-square when the generator is what it claims: outside these quantiles once
// in 10^5 tests.
void expectChi2(double statistic, int degrees_of_freedom) {
  EXPECT_GT(statistic, chi2Quantile(0.5e-5, degrees_of_freedom));
  EXPECT_LT(statistic, chi2Quantile(1 - 0.5e-5, degrees_of_freedom));
}

double statisticOf(const std::vector<int>& counts, const std::vector<double>& expected) {
  double sum = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    sum += (counts[i] - expected[i]) * (counts[i] - expected[i]) / expected[i];
  }
  return sum;
}

TEST(Random123, GivesItsKnownAnswers) {
  // kat_vectors of Random123 1.14: philox4x32, 10 rounds.
  using Philox = r123::Philox4x32;
  const auto zero = Philox()({{0, 0, 0, 0}}, {{0, 0}});
  EXPECT_EQ(zero, (Philox::ctr_type{{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}}));
  const auto pi =
      Philox()({{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}}, {{0xa4093822, 0x299f31d0}});
  EXPECT_EQ(pi, (Philox::ctr_type{{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}}));
}

TEST(Random, TheStreamOfTheZeroKeyIsThatOfPhilox) {
  Rng rng({});
  EXPECT_EQ(rng(), 0x6627e8d5u);
  EXPECT_EQ(rng(), 0xe169c58du);
  EXPECT_EQ(rng(), 0xbc57ac4cu);
  EXPECT_EQ(rng(), 0x9b00dbd8u);
}

TEST(Random, AStreamDependsOnItsKeyAlone) {
  const RngKey key{1, 2, 3, 4};
  Rng a(key), other(key.withSlot(9)), b(key);
  std::vector<std::uint32_t> first, second;
  for (int i = 0; i < 100; ++i) {
    first.push_back(a());
    other();
  }
  for (int i = 0; i < 100; ++i) second.push_back(b());
  EXPECT_EQ(first, second);
}

TEST(Random, EveryPartOfTheKeyMakesAnotherStream) {
  const RngKey key{5, 6, 7, 8};
  const RngKey keys[] = {key,
                         {6, 6, 7, 8},
                         {5, 7, 7, 8},
                         key.withSlot(8),
                         key.withPurpose(9),
                         {5ull << 32, 6, 7, 8},
                         {5, 6ull << 32, 7, 8}};
  std::set<std::vector<std::uint32_t>> streams;
  for (const auto& k : keys) {
    Rng rng(k);
    streams.insert({rng(), rng(), rng(), rng()});
  }
  EXPECT_EQ(streams.size(), std::size(keys));
}

TEST(Random, UniformNumbersFillTheUnitIntervalEvenly) {
  constexpr int kBins = 64, kDraws = 64000;
  std::vector<int> counts(kBins);
  Rng rng({11, 0, 0, 0});
  for (int i = 0; i < kDraws; ++i) {
    const double u = rng.uniform();
    ASSERT_TRUE(u >= 0 && u < 1);
    ++counts[static_cast<std::size_t>(u * kBins)];
  }
  expectChi2(statisticOf(counts, std::vector<double>(kBins, kDraws / kBins)), kBins - 1);
}

// First numbers of neighboring streams, pairwise: a table of independent rows and columns.
template <class KeyOf>
double pairStatistic(KeyOf key_of) {
  constexpr std::size_t kBins = 16, kDraws = 51200;
  std::vector<int> counts(kBins * kBins);
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    Rng a(key_of(i)), b(key_of(i + 1));
    ++counts[(a() >> 28) * kBins + (b() >> 28)];
  }
  return statisticOf(counts, std::vector<double>(kBins * kBins, double{kDraws} / (kBins * kBins)));
}

TEST(Random, NeighboringKeysAreIndependent) {
  // Pairs (i, i + 1) overlap, yet both numbers are uniform and independent: 255 degrees of freedom
  // hold to a percent.
  expectChi2(pairStatistic([](std::uint32_t i) { return RngKey{i, 1, 1, 1}; }), 255);
  expectChi2(pairStatistic([](std::uint32_t i) { return RngKey{1, i, 1, 1}; }), 255);
  expectChi2(pairStatistic([](std::uint32_t i) { return RngKey{1, 1, i, 1}; }), 255);
  expectChi2(pairStatistic([](std::uint32_t i) { return RngKey{1, 1, 1, i}; }), 255);
}

TEST(Random, NormalNumbersAreNormal) {
  constexpr int kDraws = 40000;
  Rng rng({12, 0, 0, 0});
  double sum = 0, square = 0, fourth = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double n = rng.normal();
    sum += n;
    square += n * n;
    fourth += n * n * n * n;
  }
  const double root = std::sqrt(double{kDraws});
  EXPECT_LT(std::abs(sum / root), 4.5);  // standard normal: beyond 4.5 once in 10^5
  expectChi2(square, kDraws);
  EXPECT_LT(std::abs(fourth / kDraws - 3) * root / std::sqrt(96.0), 4.5);  // var of n^4 is 105 - 9
  EXPECT_DOUBLE_EQ(Rng({1, 0, 0, 0}).normal(5, 2), 5 + 2 * Rng({1, 0, 0, 0}).normal());
}

TEST(Random, PoissonCountsFollowTheirLaw) {
  constexpr int kDraws = 20000;
  for (const double mean : {0.6, 4.0, 75.0}) {
    Rng rng({13, static_cast<std::uint64_t>(mean), 0, 0});
    double sum = 0, square = 0;
    for (int i = 0; i < kDraws; ++i) {
      const int n = rng.poisson(mean);
      sum += n;
      square += (n - mean) * (n - mean);
    }
    EXPECT_LT(std::abs(sum - kDraws * mean) / std::sqrt(kDraws * mean), 4.5);
    // (n - mean)^2 has mean m and variance m + 2 m^2.
    EXPECT_LT(std::abs(square - kDraws * mean) / std::sqrt(kDraws * (mean + 2 * mean * mean)), 4.5);
  }
  EXPECT_EQ(Rng({}).poisson(0), 0);
}

TEST(Random, ExponentialNumbersFillTheirQuantilesEvenly) {
  constexpr int kBins = 20, kDraws = 20000;
  std::vector<int> counts(kBins);
  Rng rng({14, 0, 0, 0});
  for (int i = 0; i < kDraws; ++i) {
    const double share = 1 - std::exp(-rng.exponential(3) / 3);
    ++counts[std::min<std::size_t>(kBins - 1, static_cast<std::size_t>(share * kBins))];
  }
  expectChi2(statisticOf(counts, std::vector<double>(kBins, kDraws / kBins)), kBins - 1);
}

TEST(Random, BelowIsUnbiased) {
  constexpr std::uint32_t kBins = 7;
  constexpr int kDraws = 70000;
  std::vector<int> counts(kBins);
  Rng rng({15, 0, 0, 0});
  for (int i = 0; i < kDraws; ++i) ++counts.at(rng.below(kBins));
  expectChi2(statisticOf(counts, std::vector<double>(kBins, kDraws / double{kBins})), kBins - 1);
  EXPECT_EQ(rng.below(1), 0u);
  // Just above half the range a plain remainder would give the lower half twice as often.
  int low = 0;
  const std::uint32_t n = 0xC0000000u;
  for (int i = 0; i < kDraws; ++i) low += rng.below(n) < n / 2;
  EXPECT_LT(std::abs(low - kDraws / 2.0) / std::sqrt(kDraws / 4.0), 4.5);
}

}  // namespace
}  // namespace perception
