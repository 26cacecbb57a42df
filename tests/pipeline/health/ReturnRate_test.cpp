#include "libperception/pipeline/health/ReturnRate.h"

#include <gtest/gtest.h>

#include "libperception/core/math/Random.h"
#include "tests/support/StartStamp.h"

namespace perception {
namespace {

using test::kStart;

/// Scans at 10 Hz of a road that returns about 3000 times, with a tenth of noise; from 4 s on
/// `share` of that. Returns [s] until the loss is beyond doubt; empty: never within `seconds`.
std::optional<double> namedAfter(double share, double threshold, double seconds) {
  ReturnRate rate;
  Rng rng({3, 0, 0, 0});
  for (double t = 0; t < 4 + seconds; t += 0.1) {
    const double mean = t < 4 ? 3000 : 3000 * share;
    rate.addRoad(static_cast<std::size_t>(mean * (1 + 0.1 * rng.normal())), kStart + t);
    if (rate.lost() > threshold) return t - 4;
  }
  return std::nullopt;
}

TEST(ReturnRate, ASuddenLossOfTwoThirdsIsBeyondDoubtWithinTwoSeconds) {
  const auto named = namedAfter(1.0 / 3, 10, 2);
  ASSERT_TRUE(named.has_value());
  EXPECT_GT(*named, 0.3);
}

TEST(ReturnRate, ALossOfAFifthIsNoFault) { EXPECT_FALSE(namedAfter(0.8, 10, 20).has_value()); }

TEST(ReturnRate, ASteadyRoadIsNeverDoubted) { EXPECT_FALSE(namedAfter(1, 10, 300).has_value()); }

TEST(ReturnRate, AScannerIsBlindASecondAfterItsReturnsEnd) {
  ReturnRate rate;
  for (int k = 0; k < 20; ++k) rate.add(1000, kStart + 0.1 * k);
  for (int k = 20; k < 30; ++k) rate.add(10, kStart + 0.1 * k);
  EXPECT_TRUE(rate.empty());
  EXPECT_FALSE(rate.blindFor().has_value());
  rate.add(10, kStart + 3.0);
  EXPECT_TRUE(rate.blindFor().has_value());
  rate.add(1000, kStart + 3.1);
  EXPECT_FALSE(rate.empty());
}

TEST(ReturnRate, AScannerThatNeverReturnedAnythingIsBlindAfterThreeSeconds) {
  ReturnRate rate;
  for (int k = 0; k < 30; ++k) rate.add(0, kStart + 0.1 * k);
  EXPECT_FALSE(rate.blindFor().has_value());
  rate.add(0, kStart + 3.05);
  EXPECT_TRUE(rate.blindFor().has_value());
}

}  // namespace
}  // namespace perception
