#include "studies/weather/TrustScore.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

// Four flakes of which three are doubted, two drops of which one is, five surfaces of which one is.
TrustScore score() {
  TrustScore s;
  s.add({0.1F, 0.2F, 0.3F, 0.9F, 0.4F, 0.6F, 0.45F, 0.8F, 0.95F, 0.99F, 1.F},
        {110, 110, 110, 110, 112, 112, 40, 40, 10, 111, 50});
  return s;
}

TEST(TrustScore, CountsAllKindsAgainstAllSurfaces) {
  const TrustScore::Rates r = score().at(0.5);
  EXPECT_EQ(r.found, 4u);
  EXPECT_EQ(r.false_alarms, 1u);
  EXPECT_EQ(r.missed, 2u);
  EXPECT_DOUBLE_EQ(*r.precision, 0.8);
  EXPECT_DOUBLE_EQ(*r.recall, 4.0 / 6);
  EXPECT_DOUBLE_EQ(*r.f1, 8.0 / 11);
}

TEST(TrustScore, AKindHasItsOwnRecall) {
  EXPECT_DOUBLE_EQ(*score().at(0.5, 110).recall, 0.75);
  EXPECT_DOUBLE_EQ(*score().at(0.5, 112).recall, 0.5);
  EXPECT_FALSE(score().at(0.5, 114).recall);  // no spray: no figure
  EXPECT_FALSE(score().at(0.5, 114).f1);
}

TEST(TrustScore, HalfIsNotDoubted) {
  TrustScore s;
  s.add(0.5F, 110);
  s.add(0.4999F, 110);
  EXPECT_EQ(s.at(0.5).found, 1u);
}

TEST(TrustScore, LyingSnowIsASurface) { EXPECT_EQ(score().surfaces().total(), 5u); }

TEST(TrustScore, UnlabeledCountsInSimulationsAlone) {
  TrustScore s = score();
  s.add(0.1F, 0);
  EXPECT_EQ(s.at(0.5).false_alarms, 1u);
  s.unlabeled_is_surface = true;
  EXPECT_EQ(s.at(0.5).false_alarms, 2u);
}

TEST(TrustScore, AveragePrecisionIsOneWhereAllPhantomsAreTrustedLess) {
  TrustScore s;
  s.add({0.1F, 0.2F, 0.7F, 0.8F}, {110, 113, 40, 40});
  EXPECT_DOUBLE_EQ(*s.averagePrecision(), 1);
  s.add(0.05F, 40);  // above both: precision 1/2, then 2/3
  EXPECT_DOUBLE_EQ(*s.averagePrecision(), (1.0 / 2 + 2.0 / 3) / 2);
}

TEST(TrustScore, ProbabilitiesThatAreRightHaveNoCalibrationError) {
  TrustScore s;
  for (int i = 0; i < 10; ++i) s.add(0.75F, i < 3 ? 110 : 40);
  ASSERT_EQ(s.reliability().size(), 1u);
  EXPECT_NEAR(s.reliability()[0].stated, 0.25, 1e-9);
  EXPECT_NEAR(*s.calibrationError(), 0.05, 1e-9);
  EXPECT_FALSE(TrustScore().calibrationError());
}

}  // namespace
}  // namespace perception
