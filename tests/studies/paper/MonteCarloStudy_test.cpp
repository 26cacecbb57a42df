#include "studies/paper/MonteCarloStudy.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace perception {
namespace {

TEST(MonteCarlo, GivesThePapersTableWithinItsSpread) {
  // 100 experiments of 100 tracks: bounds of a Python prototype for 10 000 tracks a class.
  const auto r = runMonteCarlo({});
  EXPECT_NEAR(r.mean.nis[0][0], 2.069, 0.02);
  EXPECT_NEAR(r.mean.nis[0][1], 7.42, 0.15);
  EXPECT_NEAR(r.mean.nis[1][0], 1.632, 0.02);
  EXPECT_NEAR(r.mean.nis[1][1], 1.933, 0.02);
  EXPECT_NEAR(r.mean.chi2[0], 0.984, 0.005);
  EXPECT_NEAR(r.mean.chi2[1], 0.796, 0.013);
}

TEST(MonteCarlo, HoldsThePapersOwnExperiment) {
  const auto r = runMonteCarlo({});
  const double paper[2][2] = {{2.0897, 7.9631}, {1.5916, 1.8784}};
  for (int t = 0; t < 2; ++t)
    for (int f = 0; f < 2; ++f)
      EXPECT_LT(std::abs(paper[t][f] - r.mean.nis[t][f]), 3 * r.deviation.nis[t][f]);
}

TEST(MonteCarlo, SequentialLikelihoodBeatsTheChiSquareRule) {
  const auto r = runMonteCarlo({});
  EXPECT_GE((r.mean.sequential[0] + r.mean.sequential[1]) / 2, 0.985);
  EXPECT_GT(r.mean.sequential[1], r.mean.chi2[1] + 0.15);
  EXPECT_LT(r.mean.least[1], 0.15);  // the smallest innovations are no rule at all
}

TEST(MonteCarlo, DoesNotDependOnTheThreads) {
  MonteCarloParams p;
  p.repeats = 3;
  const auto many = runMonteCarlo(p);
  tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto single = runMonteCarlo(p);
  EXPECT_EQ(many.mean.nis[0][1], single.mean.nis[0][1]);
  EXPECT_EQ(many.traces[1], single.traces[1]);
}

TEST(LogChi2Density, IsTheDensity) {
  EXPECT_NEAR(std::exp(logChi2Density(1.0, 2)), 0.5 * std::exp(-0.5), 1e-12);
  double integral = 0;
  for (double x = 0.005; x < 60; x += 0.01) integral += 0.01 * std::exp(logChi2Density(x, 7));
  EXPECT_NEAR(integral, 1, 1e-5);
}

}  // namespace
}  // namespace perception
