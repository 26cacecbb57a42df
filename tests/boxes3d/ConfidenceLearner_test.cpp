#include "libperception/boxes3d/ConfidenceLearner.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

ConfidenceLearner::Params params() {
  ConfidenceLearner::Params p;
  p.label_of = {{"Car", 0}};
  p.labels = {"car"};
  p.fov = kPi;
  p.clutter_per_scan = 4;
  return p;
}

ObjectDetection boxAt(double x, double y, double score, const char* label = "Car") {
  ObjectDetection o;
  o.label = label;
  o.score = score;
  o.space_box = ObjectDetection::SpaceBox{{x, y, 0}, 0, 4, 1.8, 1.5};
  return o;
}

/// How a detector writes its scores.
struct Scale {
  double factor = 1, offset = 0;
  double operator()(double score) const { return factor * score + offset; }
};

/// Ten frames a second of eight cars that stand, with scores about 2 +- 1, and of twelve false
/// boxes anywhere, about -1 +- 1: their mean score after the learner, in the last frame.
struct Means {
  double cars = 0, clutter = 0;
};
Means meansAfter(ConfidenceLearner& learner, int frames, const Scale& scale) {
  Rng rng({1, 0, 0, 0});
  Means means;
  for (int f = 0; f < frames; ++f) {
    SensorFrame frame;
    frame.stamp = Stamp{1'000'000'000'000 + f * std::int64_t{100'000'000}};
    ObjectDetections detections;
    for (int i = 0; i < 8; ++i)
      detections.objects.push_back(boxAt(10 + 6 * i, i % 2 ? 4 : -4, scale(rng.normal(2, 1))));
    for (int i = 0; i < 12; ++i)
      detections.objects.push_back(
          boxAt(rng.uniform(8, 70), rng.uniform(-40, 40), scale(rng.normal(-1, 1))));
    frame.data = std::move(detections);
    learner.apply(frame);
    means = {};
    const auto& rated = std::get<ObjectDetections>(frame.data).objects;
    for (std::size_t i = 0; i < rated.size(); ++i)
      (i < 8 ? means.cars : means.clutter) += rated[i].score / (i < 8 ? 8 : 12);
  }
  return means;
}

TEST(ConfidenceLearner, WhatStaysIsWorthMoreThanWhatComesAndGoes) {
  ConfidenceLearner learner(params());
  const Means means = meansAfter(learner, 60, {});
  EXPECT_GT(means.cars, 1);
  EXPECT_LT(means.clutter, -2.5);
}

TEST(ConfidenceLearner, TheScaleOfTheScoresDoesNotMatter) {
  ConfidenceLearner plain(params()), scaled(params());
  const Means a = meansAfter(plain, 40, {}), b = meansAfter(scaled, 40, {0.01, 500});
  EXPECT_NEAR(a.cars, b.cars, 1e-6);
  EXPECT_NEAR(a.clutter, b.clutter, 1e-6);
}

TEST(ConfidenceLearner, WithoutEvidenceLittleIsClaimed) {
  ConfidenceLearner learner(params());
  const Means means = meansAfter(learner, 1, {});
  EXPECT_GT(means.cars, means.clutter) << "by the prior alone";
  EXPECT_LT(means.cars, 2);
  EXPECT_TRUE(learner.learned().empty());
}

/// Two frames of four have false boxes that are near each other by chance, on no vehicle's way.
TEST(ConfidenceLearner, WhatJumpsAboutDoesNotStay) {
  const auto meanOf = [](double jump) {
    ConfidenceLearner learner(params());
    double sum = 0;
    for (int f = 0; f < 60; ++f) {
      SensorFrame frame;
      frame.stamp = Stamp{1'000'000'000'000 + f * std::int64_t{100'000'000}};
      ObjectDetections detections;
      for (int i = 0; i < 8; ++i)
        detections.objects.push_back(boxAt(10 + 6 * i, (f + i) % 2 ? jump : 0, i));
      frame.data = std::move(detections);
      sum = 0;
      for (const double odds : learner.learn(frame)) sum += odds;
    }
    return sum / 8;
  };
  EXPECT_GT(meanOf(0.1), 1.5);
  EXPECT_LT(meanOf(1), -1.5);
}

TEST(ConfidenceLearner, BoxesOfOtherNamesKeepTheirScores) {
  ConfidenceLearner learner(params());
  SensorFrame frame;
  ObjectDetections detections;
  detections.objects = {boxAt(10, 0, 0.4, "Tram"), boxAt(20, 0, 0.4)};
  frame.data = std::move(detections);
  learner.apply(frame);
  const auto& rated = std::get<ObjectDetections>(frame.data).objects;
  EXPECT_EQ(rated[0].score, 0.4);
  EXPECT_NE(rated[1].score, 0.4);
}

TEST(ConfidenceLearner, WhatWasLearnedIsWrittenAsKeysOfTheIni) {
  ConfidenceLearner learner(params());
  meansAfter(learner, 60, {});
  const auto lines = learner.learned();
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(lines[0], "confidence = fixed");
  EXPECT_EQ(lines[1].find("score_slope.car = "), 0U);
  const double slope = std::stod(lines[1].substr(lines[1].find('=') + 1));
  const double even = std::stod(lines[2].substr(lines[2].find('=') + 1));
  EXPECT_GT(slope, 0.5);
  EXPECT_GT(even, -1) << "between the scores of clutter ...";
  EXPECT_LT(even, 2) << "... and of cars";
}

TEST(ConfidenceLearner, ARestartForgetsPlacesAndKeepsWhatWasLearned) {
  ConfidenceLearner learner(params());
  const Means before = meansAfter(learner, 60, {});
  learner.restart();
  const Means after = meansAfter(learner, 1, {});
  EXPECT_GT(after.cars, before.cars - 1.5);
  EXPECT_LT(after.clutter, -1.5);
}

TEST(PersistenceFit, AHigherScoreIsNeverWorse) {
  PersistenceFit fit;
  for (int i = 0; i < 200; ++i) fit.add({static_cast<double>(i % 10), 20, i % 10 < 5});
  fit.fit();
  EXPECT_GE(fit.logOdds(9, 20), fit.logOdds(0, 20) - 1e-9);
}

}  // namespace
}  // namespace perception
