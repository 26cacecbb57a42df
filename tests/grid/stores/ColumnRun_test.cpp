#include "libperception/grid/stores/ColumnRun.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

constexpr std::size_t kColumns = 50;
constexpr double kTau = 3;  // [s]

/// Columns of `layers` cells with evidence in some, but none in many beside each other.
struct Columns {
  int layers;
  std::vector<std::int16_t> values;
  std::vector<std::uint64_t> hit, crossed;
  std::vector<std::uint8_t> was_hit = std::vector<std::uint8_t>(kColumns, 0);
  ColumnAges ages{kColumns, kTau};

  Columns(int count, std::uint64_t seed) : layers(count) {
    Rng rng(RngKey{seed, 0, 0, 9});
    for (std::size_t i = 0; i < kColumns * static_cast<std::size_t>(layers); ++i)
      values.push_back(static_cast<std::int16_t>(LogOddsColumn::units(rng.uniform(-2, 3.5))));
    const std::uint64_t all = ~std::uint64_t{0} >> (64 - layers);
    const auto some = [&] {
      return (std::uint64_t{rng()} << 32 | rng()) & (std::uint64_t{rng()} << 32 | rng()) & all;
    };
    for (std::size_t i = 0; i < kColumns; ++i) {
      const bool seen = i < 16 || i >= 40;
      hit.push_back(seen && i % 3 == 0 ? some() : 0);
      crossed.push_back(!seen || i % 5 == 0 ? 0 : some());
    }
    ages.advance(0.4);
  }
};

std::uint64_t turnedBy(std::uint64_t mask, unsigned turn, int layers) {
  const std::uint64_t all = ~std::uint64_t{0} >> (64 - layers);
  return turn == 0 ? mask : (mask << turn | mask >> (static_cast<unsigned>(layers) - turn)) & all;
}

TEST(ColumnRun, UpdatesAsEachColumnByItself) {
  const LogOddsColumn rules(1.2, -0.4, -2, 3.5);
  for (const int layers : {4, 12, 16, 20, 36, 64}) {
    for (const bool judged : {false, true}) {
      Columns run(layers, 7);
      const Columns before(layers, 7);
      constexpr unsigned kTurn = 3;
      updateColumns(
          rules,
          ColumnRun<std::uint64_t>{run.values.data(), run.hit.data(), run.crossed.data(),
                                   run.was_hit.data(), 0, kColumns, layers, kTurn, judged},
          run.ages);
      std::vector<std::int16_t> expected = before.values;
      for (std::size_t i = 0; i < kColumns; ++i) {
        const std::uint64_t hit = before.hit[i], crossed = before.crossed[i] & ~hit;
        std::int16_t* const values = &expected[i * static_cast<std::size_t>(layers)];
        if ((hit | crossed) != 0)
          rules.update(values, layers, before.ages.loss(i), turnedBy(hit, kTurn, layers),
                       turnedBy(crossed, kTurn, layers), judged);
        EXPECT_EQ(run.was_hit[i] != 0, hit != 0) << i;
        EXPECT_EQ(run.hit[i] | run.crossed[i], 0U) << i;
      }
      EXPECT_EQ(run.values, expected) << layers;
    }
  }
}

}  // namespace
}  // namespace perception
