#include "libperception/lidar/PhantomMix.h"

#include <gtest/gtest.h>

#include <numeric>

namespace perception {
namespace {

using Probabilities = PhantomMix::Probabilities;

// Pedestrian, cyclist, vehicle, thing, phantom, mixed.
constexpr Probabilities kPrior = {0.02, 0.02, 0.06, 0.792, 0.008, 0.1};
constexpr Probabilities kSpray = {0, 0, 0.02, 0.5, 0.46, 0.02};
constexpr Probabilities kWall = {0, 0, 0.02, 0.97, 0.001, 0.009};
constexpr std::size_t kThing = 3, kPhantom = 4;

TEST(PhantomMix, OfNoClustersIsThePrior) {
  const PhantomMix mix({}, kPrior);
  EXPECT_NEAR(mix.share(), 0.01, 1e-12);
  const Probabilities p = mix(kSpray);
  for (std::size_t k = 0; k < p.size(); ++k) EXPECT_NEAR(p[k], kSpray[k], 1e-12);
}

TEST(PhantomMix, ManyClustersLikeSprayMakeEachOneSurer) {
  const PhantomMix mix(std::vector<Probabilities>(30, kSpray), kPrior);
  EXPECT_GT(mix.share(), 0.3);
  const Probabilities p = mix(kSpray);
  EXPECT_GT(p[kPhantom], 0.95);
  EXPECT_NEAR(std::accumulate(p.begin(), p.end(), 0.0), 1, 1e-12);
  // The ratio of all other kinds to each other stays what it was.
  EXPECT_NEAR(p[2] / p[5], kSpray[2] / kSpray[5], 1e-12);
}

TEST(PhantomMix, InClearAirClustersAreJudgedAsTheyWereLearned) {
  std::vector<Probabilities> scan(100, kWall);
  scan.push_back(kSpray);
  const PhantomMix mix(scan, kPrior);
  EXPECT_NEAR(mix.share(), 0.01, 1e-12);
  EXPECT_NEAR(mix(kSpray)[kPhantom], kSpray[kPhantom], 1e-12);
}

TEST(PhantomMix, ThingsAreNeverOutOfTheQuestion) {
  const Probabilities sure = {0, 0, 0, 1e-6, 1 - 1e-6, 0};
  const PhantomMix mix(std::vector<Probabilities>(10000, sure), kPrior);
  EXPECT_DOUBLE_EQ(mix.share(), 0.9);
  EXPECT_GT(mix(kWall)[kThing], mix(kWall)[kPhantom]);
}

TEST(PhantomMix, AClassifierThatKnowsNoPhantomsStaysAsItIs) {
  const Probabilities prior = {0.1, 0.1, 0.2, 0.6, 0, 0};
  const PhantomMix mix({kWall, kSpray}, prior);
  EXPECT_EQ(mix(kWall)[kThing], kWall[kThing]);
}

}  // namespace
}  // namespace perception
