#include "libperception/boxes3d/ScoreOdds.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

TEST(FitScoreOdds, FindsTheLawThatDrewTheSamples) {
  Rng rng(RngKey{5, 0, 0, 0});
  const ScoreOdds law{2, 1.2, 0.03};
  std::vector<BoxSample> samples(20000);
  for (BoxSample& s : samples) {
    s.score = 8 * rng.uniform() - 2;
    s.range = 60 * rng.uniform();
    s.object = rng.uniform() < 1 / (1 + std::exp(-law.logOdds(s.score, s.range)));
  }
  const ScoreOdds fitted = fitScoreOdds(samples, 1e-3);
  EXPECT_NEAR(fitted.slope, law.slope, 0.06);  // about four deviations of the estimates
  EXPECT_NEAR(fitted.offset, law.offset, 0.25);
  EXPECT_NEAR(fitted.fade, law.fade, 0.006);
  EXPECT_LE(logLoss(fitted, samples), logLoss(law, samples));
}

TEST(FitScoreOdds, NothingToFitGivesNoEvidence) { EXPECT_EQ(fitScoreOdds({}).logOdds(3, 10), 0); }

TEST(LogLoss, OfEvenOddsIsThatOfACoin) {
  EXPECT_NEAR(logLoss({}, {{3, 10, true}, {4, 10, false}}), std::log(2), 1e-12);
  EXPECT_NEAR(logLoss({0, 100, 0}, {{1, 0, false}}), 100, 1e-9);
}

}  // namespace
}  // namespace perception
