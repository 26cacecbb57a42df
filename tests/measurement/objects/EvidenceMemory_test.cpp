#include "libperception/measurement/objects/EvidenceMemory.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

const EvidenceMemory kMemory{0.2, 0.9, 0.2, 0.3, 1, 0.5};

TEST(EvidenceMemory, ViewsAlikeHaveTheCorrelationKept) {
  EXPECT_EQ(kMemory.correlation({1, 2}, {1, 2}, 0), 0.9);
}

TEST(EvidenceMemory, CorrelationFallsToOneEthWithEachChange) {
  const double fallen = 0.9 * std::exp(-1);
  EXPECT_NEAR(kMemory.correlation({1, 2}, {1.2, 2}, 0), fallen, 1e-12);
  EXPECT_NEAR(kMemory.correlation({1, 2}, {1, 1.7}, 0), fallen, 1e-12);
  EXPECT_NEAR(kMemory.correlation({1, 2}, {1, 2}, 1), fallen, 1e-12);
  EXPECT_NEAR(kMemory.correlation({1, 2}, {1.2, 2.3}, 1), 0.9 * std::exp(-3), 1e-12);
}

TEST(EvidenceMemory, CorrelationIsTheSameBothWays) {
  const EvidenceView a{0.3, 2.5}, b{0.5, 2.2};
  EXPECT_EQ(kMemory.correlation(a, b, 0.4), kMemory.correlation(b, a, -0.4));
  EXPECT_EQ(kMemory.say(a, b), kMemory.say(b, a));
}

TEST(EvidenceMemory, BearingsAreThoseOfACircle) {
  const EvidenceView a{kPi - 0.05, 2}, b{-kPi + 0.05, 2};
  EXPECT_NEAR(kMemory.correlation(a, b, 0), 0.9 * std::exp(-0.5), 1e-12);
  EXPECT_NEAR(kMemory.say(a, b), std::exp(-0.2), 1e-12);
}

TEST(EvidenceMemory, SayFallsToOneEthByTheRenewal) {
  EXPECT_EQ(kMemory.say({1, 2}, {1, 2}), 1);
  EXPECT_NEAR(kMemory.say({1, 2}, {1.5, 2}), std::exp(-1), 1e-12);
  EXPECT_NEAR(kMemory.say({1, 2}, {1, 2.5}), std::exp(-1), 1e-12);
}

TEST(EvidenceMemory, AnIndependentViewIsWorthALookAndARepeatedOneNothing) {
  EXPECT_EQ(EvidenceMemory::worth(0), 1);
  EXPECT_EQ(EvidenceMemory::worth(1), 0);
  EXPECT_NEAR(EvidenceMemory::worth(0.9), 0.1 / 1.9, 1e-15);
}

/// For n views of an AR(1) process the variance of the mean tends to that of n (1 - r) / (1 + r)
/// independent ones.
TEST(EvidenceMemory, WorthIsThatOfAViewInALongRow) {
  const double r = 0.7;
  const int n = 4000;
  double sum = n;  // of all correlations
  for (int lag = 1; lag < n; ++lag) sum += 2 * (n - lag) * std::pow(r, lag);
  const double independent = static_cast<double>(n) * n / sum;
  EXPECT_NEAR(independent / n, EvidenceMemory::worth(r), 1e-3);
}

TEST(EvidenceMemory, WhatStaysBoundsTheLooks) {
  EXPECT_EQ(kMemory.looks(1), 1);
  EXPECT_NEAR(kMemory.looks(2), 2 / 1.2, 1e-15);
  EXPECT_NEAR(kMemory.looks(1e9), 1 / 0.2, 1e-6);
  for (double views = 1; views < 100; ++views)
    EXPECT_LT(kMemory.looks(views), kMemory.looks(views + 1));
  EvidenceMemory independent = kMemory;
  independent.lasting = 0;
  EXPECT_EQ(independent.looks(17), 17);
}

}  // namespace
}  // namespace perception
