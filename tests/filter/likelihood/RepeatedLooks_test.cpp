#include "libperception/filter/likelihood/RepeatedEvidence.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/filter/likelihood/RememberingSensor.h"

namespace perception {
namespace {

using test::odds;
using test::positionScan;
using test::RememberingModel;
using test::RepeatFixture;
using test::Repeats;

/// P_D .8 and .6, label 0 with .7 and .4, classes alike but for that.
struct Looking : RepeatFixture {
  Looking() { repeats = Repeats::kLooks; }
  MeasurementScan scan(double t, bool detected) const {
    PositionModel::Params params = test::linearSensor();
    params.classes[1].noise = params.classes[0].noise;
    const auto model = std::make_shared<const RememberingModel>(params, memory, repeats);
    MeasurementScan scan = positionScan(model, t, {{1, 2, 0}});
    if (!detected) scan.measurements.clear();
    return scan;
  }
  Track missed(const Track& before, const MeasurementScan& scan) const {
    const Track track = predictTrack(before, scan.state.stamp, model);
    return missTrack(track, likelihoodTable({track}, scan, model).tracks[0], scan, model);
  }
};

const double kHit = std::log(0.8 * 0.7) - std::log(0.6 * 0.4);
const double kMiss = std::log(0.2) - std::log(0.4);

TEST(RepeatedLooks, ABirthIsADetection) {
  const Looking f;
  const Track track = f.born(f.scan(0, true));
  EXPECT_NEAR(odds(track), std::log(0.6 / 0.4) + kHit, 1e-6);
  ASSERT_EQ(track.evidence.size(), 1u);
  EXPECT_NEAR(track.evidence[0].mean[0] - track.evidence[0].mean[1], kHit, 1e-6);
}

TEST(RepeatedLooks, TheRateOfBirthsIsThatOfFirstDetections) {
  Looking f;
  const auto rate = [&](double detection) {
    PositionModel::Params params = test::linearSensor();
    for (auto& row : params.classes) row.detection = detection, row.labels = {0.5, 0.5};
    const auto model = std::make_shared<const RememberingModel>(params, f.memory, f.repeats);
    return likelihoodTable({}, positionScan(model, 0, {{1, 2, 0}}), f.model).births[0].log_birth;
  };
  EXPECT_NEAR(rate(0.9), rate(0.1), 1e-9);
}

TEST(RepeatedLooks, DetectionsAlikeAreBounded) {
  const Looking f;
  const double prior = std::log(0.6 / 0.4);
  Track track = f.born(f.scan(0, true));
  for (int k = 1; k <= 300; ++k) track = f.hit(track, f.scan(0.1 * k, true));
  EXPECT_GT(odds(track), prior + 0.8 * kHit / 0.2);
  EXPECT_LT(odds(track), prior + kHit / 0.2);
}

TEST(RepeatedLooks, MissesAreLooksAsWell) {
  const Looking f;
  const double prior = std::log(0.6 / 0.4);
  Track track = f.born(f.scan(0, true));
  double before = odds(track);
  for (int k = 1; k <= 40; ++k) {
    track = f.missed(track, f.scan(0.1 * k, false));
    EXPECT_LT(odds(track), before) << k;
    before = odds(track);
  }
  const EvidenceSeen& seen = track.evidence.at(0);
  EXPECT_NEAR(odds(track), prior + f.memory.looks(seen.views) * (seen.mean[0] - seen.mean[1]),
              1e-3);
  EXPECT_GT(odds(track), prior + kMiss / 0.2);
}

TEST(RepeatedLooks, WhatIsHiddenTellsNothing) {
  const Looking f;
  const auto scan = f.scan(1, false);
  const Track track = f.born(f.scan(0, true));
  ClassValues detection;
  detection.assign(2, 0.01);
  EXPECT_FALSE(missedLook(track, scan, detection, 0));
  const auto look = missedLook(track, scan, detection, 0.1);
  ASSERT_TRUE(look);
  EXPECT_EQ(look->weight, 0.1);
  Look whole = *look;
  whole.weight = 1;
  EXPECT_LT(RepeatedEvidence(track, *look, scan).views(),
            RepeatedEvidence(track, whole, scan).views());
}

TEST(RepeatedLooks, AClassNeverDetectedThereIsNotRuledOut) {
  const Looking f;
  const auto scan = f.scan(0, true);
  const Track track = f.born(scan);
  ClassValues detection;
  detection.assign(2, 0);
  const Look nowhere = *lookOf(track, scan.measurements[0], scan, detection);
  for (const double value : nowhere.said) EXPECT_EQ(value, 0);
  detection[0] = 0.5;
  EXPECT_GT(lookOf(track, scan.measurements[0], scan, detection)->said[1], -20);
}

}  // namespace
}  // namespace perception
