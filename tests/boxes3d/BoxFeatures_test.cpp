#include "libperception/boxes3d/BoxFeatures.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/Random.h"

namespace perception {
namespace {

ObjectDetection carAt(double score, double x, double z, double length = 4) {
  ObjectDetection o;
  o.label = "Car";
  o.score = score;
  o.space_box = ObjectDetection::SpaceBox{{x, 0, z}, 0, length, 1.6, 1.5};
  return o;
}

const SizePrior kCar{4, 1.6, 1.5, 0, 0.5, 0.1, 0.1, 0.2};

double at(const BoxFeatureVector& f, BoxFeature which) {
  return f[static_cast<std::size_t>(which)];
}

TEST(BoxFeatures, AUsualBoxAloneOnTheGroundHasNone) {
  ObjectDetections d;
  d.objects = {carAt(3, 20, -1.7)};
  for (const double f : boxFeatures(d, 0, kCar, makePose(0, 0, 1.7, 0))) EXPECT_NEAR(f, 0, 1e-12);
}

TEST(BoxFeatures, MisfitsAreSquaredSpreadsUpToFour) {
  ObjectDetections d;
  d.objects = {carAt(3, 20, -1.3, 5), carAt(3, 40, -1.7, 20)};
  const Pose3 sensor = makePose(0, 0, 1.7, 0);
  EXPECT_NEAR(at(boxFeatures(d, 0, kCar, sensor), BoxFeature::kLength), 4, 1e-12);
  EXPECT_NEAR(at(boxFeatures(d, 0, kCar, sensor), BoxFeature::kBase), 4, 1e-9);
  EXPECT_NEAR(at(boxFeatures(d, 0, kCar, sensor), BoxFeature::kSlope), 0.4 * 20 / 10, 1e-3);
  EXPECT_EQ(at(boxFeatures(d, 1, kCar, sensor), BoxFeature::kLength), 16);
}

TEST(BoxFeatures, OnlyABetterBoxOfTheSameLabelIsANeighbor) {
  ObjectDetections d;
  d.objects = {carAt(3, 20, 0), carAt(5, 22, 0), carAt(9, 20.5, 0)};
  d.objects[2].label = "Pedestrian";
  EXPECT_NEAR(at(boxFeatures(d, 0, kCar, {Pose3::Identity()}), BoxFeature::kNeighbor), std::exp(-1),
              1e-12);
  EXPECT_EQ(at(boxFeatures(d, 1, kCar, {Pose3::Identity()}), BoxFeature::kNeighbor), 0);
}

TEST(FitBoxEvidence, FindsTheLawThatDrewTheSamples) {
  Rng rng(RngKey{5, 0, 0, 0});
  BoxEvidence law;
  law.slope = 1.2, law.offset = 2, law.fade = 0.03;
  law.weights[0] = -0.3;
  std::vector<BoxSample> samples(20000);
  for (BoxSample& s : samples) {
    s.score = 8 * rng.uniform() - 2;
    s.range = 60 * rng.uniform();
    s.features[0] = 10 * rng.uniform();
    s.object = rng.uniform() < 1 / (1 + std::exp(-law.logOdds(s.score, s.range, s.features)));
  }
  const BoxEvidence full = fitBoxEvidence(samples, true, 1e-3);
  EXPECT_NEAR(full.slope, law.slope, 0.06);  // about four deviations of the estimates
  EXPECT_NEAR(full.offset, law.offset, 0.25);
  EXPECT_NEAR(full.fade, law.fade, 0.006);
  EXPECT_NEAR(full.weights[0], law.weights[0], 0.04);
  const BoxEvidence plain = fitBoxEvidence(samples, false, 1e-3);
  EXPECT_EQ(plain.weights[0], 0);
  EXPECT_LT(logLoss(full, samples), logLoss(plain, samples));
}

TEST(FitBoxEvidence, NothingToFitGivesNoEvidence) {
  EXPECT_EQ(fitBoxEvidence({}, true).logOdds(3, 10, {}), 0);
}

}  // namespace
}  // namespace perception
