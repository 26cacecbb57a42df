#include "libperception/calibration/clusters/ShapeExamples.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

constexpr auto kVehicle = static_cast<std::size_t>(ClusterKind::kVehicle);

/// Recordings with vehicles of any shape about that of the recording.
struct Recordings {
  ClusterSamples samples;
  std::vector<TrainingLog> logs;

  /// `offset`: of the logs of the recording's lengths.
  void add(int vehicles, double offset = 0, double spread = 0.5) {
    Rng rng(RngKey{3, logs.size(), 0, 11});
    for (int i = 0; i < vehicles; ++i) {
      ClusterSample s;
      s.log = logs.size(), s.kind = ClusterKind::kVehicle;
      for (const Feature f : KnownShapes::kFeaturesUsed)
        s.descriptor[static_cast<std::size_t>(f)] =
            static_cast<float>(std::exp(offset + spread * rng.normal()));
      samples.clusters.push_back(s);
    }
    logs.push_back({"a recording", false});
  }
  KnownShapes::OfKind vehicles() const {
    return shapeExamples(samples, logs, logs.size()).of(kVehicle);
  }
};

TEST(ShapeExamples, WhatRecordingsHaveInCommonIsKnown) {
  Recordings r;
  for (int i = 0; i < 4; ++i) r.add(200);
  const KnownShapes::OfKind known = r.vehicles();
  EXPECT_GT(known.within, 0.2);
  EXPECT_LT(known.within, 1.2);
  std::size_t within = 0;
  for (const ClusterSample& s : r.samples.clusters)
    within += known.distance(KnownShapes::geometryOf(s.descriptor)) <= known.within;
  EXPECT_GT(within, 9 * r.samples.clusters.size() / 10);
}

TEST(ShapeExamples, OneRecordingOfOtherThingsDoesNotWidenWhatIsKnown) {
  Recordings r;
  for (int i = 0; i < 4; ++i) r.add(200);
  const double before = r.vehicles().within;
  r.add(200, 6);
  EXPECT_LT(r.vehicles().within, 1.5 * before);
}

TEST(ShapeExamples, SamplesThatAreAlikeAreOneExample) {
  Recordings r;
  for (int i = 0; i < 3; ++i) r.add(20);
  const std::size_t before = r.vehicles().examples.size();
  const std::vector<ClusterSample> once = r.samples.clusters;
  r.samples.clusters.insert(r.samples.clusters.end(), once.begin(), once.end());
  EXPECT_EQ(r.vehicles().examples.size(), before);
}

TEST(ShapeExamples, ThreeRecordingsHaveToShowAKindFiveTimes) {
  Recordings r;
  r.add(20), r.add(20);
  EXPECT_EQ(r.vehicles().within, 0);
  r.add(4);
  EXPECT_EQ(r.vehicles().within, 0);
  r.add(5);
  EXPECT_GT(r.vehicles().within, 0);
  EXPECT_EQ(shapeExamples(r.samples, r.logs, 3).of(0).within, 0) << "no pedestrian";
  EXPECT_EQ(shapeExamples(r.samples, r.logs, 0).of(kVehicle).within, 0) << "one is left out";
  r.logs[1].simulated = true;
  EXPECT_EQ(r.vehicles().within, 0);
}

TEST(ShapeExamples, ExamplesHaveThreeDecimalsAndNoNegativeZero) {
  Recordings r;
  for (int i = 0; i < 3; ++i) r.add(20);
  r.samples.clusters[0].descriptor[static_cast<std::size_t>(Feature::kWidth)] = 0.9999f;
  for (const auto& example : r.vehicles().examples)
    for (const float v : example) {
      EXPECT_EQ(v, static_cast<float>(std::round(static_cast<double>(v) * 1000) / 1000));
      EXPECT_FALSE(v == 0 && std::signbit(v)) << "a file would not keep it";
    }
}

}  // namespace
}  // namespace perception
