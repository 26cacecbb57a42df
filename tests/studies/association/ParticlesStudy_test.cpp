#include "studies/association/ParticlesStudy.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

TEST(ParticlesStudy, NewbornsThatMayBeClutterHalveTheErrorOfDrawnBirths) {
  const int scenes = 20;
  const auto duc = runParticles({"", Proposal::kSampled, true, 8, 1}, scenes);
  const auto joint = runParticles({"", Proposal::kSampled, false, 8, 1}, scenes);
  const double drawn = compareParticles(duc, duc).truth_rms;
  EXPECT_LE(compareParticles(joint, joint).truth_rms, 0.5 * drawn);
}

TEST(CompareParticles, FindsNoErrorAgainstItself) {
  const auto runs = runParticles({"", Proposal::kSampled, false, 4, 1}, 2);
  const auto f = compareParticles(runs, runs);
  EXPECT_EQ(f.count_rms, 0);
  EXPECT_EQ(f.classified_rms, 0);
  EXPECT_EQ(f.error_cdf.front(), 1);
  EXPECT_GT(f.truth_rms, 0);
}

}  // namespace
}  // namespace perception
