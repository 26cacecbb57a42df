#include "libperception/filter/state/Heading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/Random.h"

namespace perception {
namespace {

MeasuredHeading seen(double yaw, double flip = 0.2) { return {yaw, 0.14, flip, 0}; }

TEST(HeadingResidual, IsFoldedOntoTheNearerDirection) {
  const auto same = headingResidual(seen(0.3), 0.1, HeadingMode::kSplit);
  EXPECT_TRUE(same.same);
  EXPECT_NEAR(same.y, 0.2, 1e-12);
  const auto opposite = headingResidual(seen(0.3 + kPi), 0.1, HeadingMode::kSplit);
  EXPECT_FALSE(opposite.same);
  EXPECT_NEAR(opposite.y, 0.2, 1e-12);
}

TEST(HeadingResidual, OfTheWideGaussianIsNotFolded) {
  const auto r = headingResidual(seen(3.0), 0.1, HeadingMode::kWide);
  EXPECT_NEAR(r.y, 2.9, 1e-12);
  EXPECT_NEAR(r.variance, 0.14 * 0.14 + 0.2 * kPi * kPi, 1e-12);
}

TEST(HeadingRatio, IntegratesToOneOverTheCircle) {
  double integral = 0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double z = -kPi + kTwoPi * (i + 0.5) / n;
    integral += std::exp(logHeadingRatio(seen(z, 0.3), 0.7, 0.02, HeadingMode::kSplit)) / n;
  }
  EXPECT_NEAR(integral, 1, 1e-6);
}

TEST(FrontBackAmbiguity, IsOpenForWhatNeverMoved) {
  EXPECT_EQ(FrontBackAmbiguity{}.frontProbability(), 0.5);
}

TEST(FrontBackAmbiguity, AShiftOfLessThanALengthTellsLittle) {
  FrontBackAmbiguity bit;
  bit.traveled = 1;
  EXPECT_LT(bit.frontProbability(), 0.8);
}

TEST(FrontBackAmbiguity, WhatWentForTensOfMetersShowsItsFront) {
  FrontBackAmbiguity bit;
  bit.traveled = 5;
  EXPECT_GT(bit.frontProbability(), 0.97);
  const double near = bit.frontProbability();
  bit.traveled = 50;
  EXPECT_GT(bit.frontProbability(), near);
  EXPECT_LT(bit.frontProbability(), 0.999);
}

TEST(FrontBackAmbiguity, ReversedSaysTheOppositeOfItself) {
  FrontBackAmbiguity bit = firstFrontBack(seen(0, 0.3));
  bit.traveled = -4;
  EXPECT_NEAR(bit.frontProbability() + bit.reversed().frontProbability(), 1, 1e-12);
  EXPECT_LT(bit.frontProbability(), 0.1);
}

TEST(FrontBackAmbiguity, ViewsOfTheShapeCountByTheirMean) {
  FrontBackAmbiguity bit;
  for (int i = 0; i < 50; ++i) seeShape(i % 2 == 0 ? 3 : 1, bit);
  EXPECT_NEAR(bit.frontProbability(), 1 / (1 + std::exp(-2)), 0.02);
  EXPECT_NEAR(bit.frontProbability() + bit.reversed().frontProbability(), 1, 1e-12);
  for (int i = 0; i < 60; ++i) seeShape(-3, bit);
  EXPECT_LT(bit.frontProbability(), 0.1) << "another object's views fade";
}

TEST(FrontBackAmbiguity, OfDetectionsIsTheirShareThatIsRight) {
  EXPECT_NEAR(firstFrontBack(seen(0, 0.3)).frontProbability(), 0.7, 1e-9);
}

TEST(FrontBackAmbiguity, OfLogOddsIsTheMajorityForConstantAccuracyAndUnknownSpeed) {
  // Up to the slow forgetting: sequences whose sums are clear.
  Rng rng({4, 0, 0, 0});
  for (int trial = 0; trial < 200; ++trial) {
    FrontBackAmbiguity bit = firstFrontBack(seen(0, 0.4));
    for (int i = 0; i < 8; ++i) bit = nextFrontBack(bit, rng.uniform() < 0.5, seen(0, 0.4));
    if (std::abs(bit.same - bit.opposite) < 3) continue;
    EXPECT_EQ(asksForReversal(bit, 0, 1e6, HeadingMode::kSplit), bit.opposite > bit.same);
  }
}

TEST(FrontBackAmbiguity, OfBurstsIsThePosteriorOfAChainOfTwoStates) {
  // Both headings, all headings' detections under each: the log-odds are the ratio of the two
  // products of the chain's probabilities (but for the slow forgetting).
  const double p = 0.01, repeats = 0.4, after_right = p * (1 - repeats) / (1 - p);
  MeasuredHeading burst = seen(0, p);
  burst.flip_persistence = repeats;
  const std::vector<bool> same{true, true, false, false, true};
  const auto likelihood = [&](bool theta_right) {
    double l = same[0] == theta_right ? 1 - p : p;
    for (std::size_t i = 1; i < same.size(); ++i) {
      const double reversed = same[i - 1] == theta_right ? after_right : repeats;
      l *= same[i] == theta_right ? 1 - reversed : reversed;
    }
    return l;
  };
  FrontBackAmbiguity bit = firstFrontBack(burst);
  for (std::size_t i = 1; i < same.size(); ++i) bit = nextFrontBack(bit, same[i], burst);
  EXPECT_NEAR(bit.log_odds, std::log(likelihood(true) / likelihood(false)), 0.5);
}

TEST(FrontBackAmbiguity, OutlivesABurstOfReversals) {
  MeasuredHeading burst = seen(0, 0.007);
  const auto afterTwentyAndFour = [&] {
    FrontBackAmbiguity bit = firstFrontBack(burst);
    for (int i = 0; i < 20; ++i) bit = nextFrontBack(bit, true, burst);
    for (int i = 0; i < 4; ++i) bit = nextFrontBack(bit, false, burst);
    return bit;
  };
  EXPECT_TRUE(asksForReversal(afterTwentyAndFour(), 0, 1, HeadingMode::kSplit));
  burst.flip_persistence = 0.4;
  EXPECT_FALSE(asksForReversal(afterTwentyAndFour(), 0, 1, HeadingMode::kSplit));
}

TEST(FrontBackAmbiguity, GivesWayToAClearSpeed) {
  const FrontBackAmbiguity one = firstFrontBack(seen(0, 0.2));
  EXPECT_TRUE(asksForReversal(one, -5, 0.25, HeadingMode::kSplit));
  EXPECT_FALSE(asksForReversal(one, 5, 0.25, HeadingMode::kSplit));
  EXPECT_FALSE(asksForReversal(one, -0.05, 0.25, HeadingMode::kSplit));
}

TEST(FrontBackAmbiguity, OfADetectorWithoutDirectionSaysNothing) {
  FrontBackAmbiguity bit;
  for (int i = 0; i < 10; ++i) bit = nextFrontBack(bit, i % 3 == 0, seen(0, 0.5));
  EXPECT_NEAR(bit.log_odds, 0, 1e-12);
}

}  // namespace
}  // namespace perception
