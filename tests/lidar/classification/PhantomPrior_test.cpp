#include "libperception/lidar/classification/PhantomPrior.h"

#include <gtest/gtest.h>

#include <numeric>

namespace perception {
namespace {

using Probabilities = PhantomPrior::Probabilities;

// Pedestrian, cyclist, vehicle, thing, phantom, mixed.
constexpr Probabilities kLearned = {0.02, 0.02, 0.06, 0.792, 0.008, 0.1};
constexpr Probabilities kSpray = {0, 0, 0.02, 0.5, 0.46, 0.02};
constexpr Probabilities kWall = {0, 0, 0.02, 0.97, 0.001, 0.009};
constexpr CausesHere kWake{0, 0, 0.9};
constexpr std::size_t kThing = 3, kPhantom = 4;

TEST(PhantomPrior, WithoutACauseClustersAreJudgedAsTheyWereLearned) {
  const PhantomPrior prior(kLearned);
  EXPECT_NEAR(prior.share({}), 0.01, 1e-12);
  const Probabilities p = prior(kSpray, {});
  for (std::size_t k = 0; k < p.size(); ++k) EXPECT_NEAR(p[k], kSpray[k], 1e-12);
}

TEST(PhantomPrior, ACauseMakesWhatLooksLikeSpraySurer) {
  const PhantomPrior prior(kLearned);
  const Probabilities p = prior(kSpray, kWake);
  EXPECT_GT(p[kPhantom], 0.95);
  EXPECT_NEAR(std::accumulate(p.begin(), p.end(), 0.0), 1, 1e-12);
  // The ratio of all other kinds to each other stays what it was.
  EXPECT_NEAR(p[2] / p[5], kSpray[2] / kSpray[5], 1e-12);
  EXPECT_GT(prior(kWall, kWake)[kThing], prior(kWall, kWake)[kPhantom]);
}

TEST(PhantomPrior, GrowsWithTheProbabilityOfTheCause) {
  const PhantomPrior prior(kLearned);
  for (double CausesHere::*cause : {&CausesHere::weather, &CausesHere::cloud, &CausesHere::wake}) {
    CausesHere causes;
    double before = prior(kSpray, causes)[kPhantom];
    for (const double probability : {0.1, 0.5, 0.9}) {
      causes.*cause = probability;
      const double now = prior(kSpray, causes)[kPhantom];
      EXPECT_GT(now, before);
      before = now;
    }
  }
}

TEST(PhantomPrior, AClassifierThatKnowsNoPhantomsStaysAsItIs) {
  const PhantomPrior prior({0.1, 0.1, 0.2, 0.6, 0, 0});
  EXPECT_EQ(prior(kWall, kWake)[kThing], kWall[kThing]);
}

}  // namespace
}  // namespace perception
