#include "libperception/calibration/detectors/Intervals.h"

#include <gtest/gtest.h>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

constexpr int kLogs = 1000, kBlocks = 20, kChances = 60;

/// Share of simulated logs whose interval holds the true P_D. `repeated`: chance to be as the scan
/// before, as of an object that stays hidden.
double sharesCovered(double p, double repeated) {
  int covered = 0;
  for (int log = 0; log < kLogs; ++log) {
    Rng rng({static_cast<std::uint64_t>(log), 1, 0, 0});
    std::vector<BlockCount> blocks(kBlocks);
    bool seen = rng.uniform() < p;
    for (BlockCount& block : blocks) {
      for (int i = 0; i < kChances; ++i) {
        if (rng.uniform() >= repeated) seen = rng.uniform() < p;
        block.events += seen, ++block.chances;
      }
    }
    const CredibleInterval found = shareInterval(blocks);
    covered += found.low <= p && p <= found.high;
  }
  return static_cast<double>(covered) / kLogs;
}

/// The same of clutter: `clusters` detections at once.
double ratesCovered(double rate, int clusters) {
  int covered = 0;
  for (int log = 0; log < kLogs; ++log) {
    Rng rng({static_cast<std::uint64_t>(log), 2, 0, 0});
    std::vector<BlockCount> blocks(kBlocks);
    for (BlockCount& block : blocks) {
      block.chances = kChances;
      block.events = clusters * rng.poisson(rate * kChances / clusters);
    }
    const CredibleInterval found = rateInterval(blocks);
    covered += found.low <= rate && rate <= found.high;
  }
  return static_cast<double>(covered) / kLogs;
}

TEST(Intervals, CoverTheDetectionProbabilityOfIndependentScans) {
  EXPECT_NEAR(sharesCovered(0.9, 0), 0.9, 0.05);
  EXPECT_NEAR(sharesCovered(0.4, 0), 0.9, 0.05);
}

TEST(Intervals, CoverTheDetectionProbabilityOfScansThatRepeat) {
  EXPECT_NEAR(sharesCovered(0.9, 0.8), 0.9, 0.05);
  EXPECT_NEAR(sharesCovered(0.4, 0.8), 0.9, 0.05);
}

TEST(Intervals, CoverTheRateOfClutter) {
  EXPECT_NEAR(ratesCovered(0.5, 1), 0.9, 0.05);
  EXPECT_NEAR(ratesCovered(0.5, 3), 0.9, 0.05);
}

TEST(Intervals, AreBetweenNoneAndAllAtTheEnds) {
  const CredibleInterval none = shareInterval({{0, 20}}), all = shareInterval({{20, 20}});
  EXPECT_GT(none.high, 0.05);
  EXPECT_LT(none.high, 0.2);
  EXPECT_GE(none.low, 0);
  EXPECT_LE(all.high, 1);
  EXPECT_LT(all.low, 0.95);
  EXPECT_GT(rateInterval({{0, 100}}).high, 0);
}

}  // namespace
}  // namespace perception
