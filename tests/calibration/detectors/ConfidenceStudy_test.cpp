#include "libperception/calibration/detectors/ConfidenceStudy.h"

#include <gtest/gtest.h>

#include "libperception/core/Error.h"
#include "libperception/evaluation/matching/TruthSelection.h"

namespace perception {
namespace {

constexpr int kInstants = 40;
constexpr double kStep = 0.1;  // [s]

/// A car stands 10 m ahead; every second box is on it, and scores tell which.
BoxLog boxes(const char* name) {
  BoxLog log;
  log.name = name;
  log.scans = kInstants;
  for (int i = 0; i < 2 * kInstants; ++i)
    log.boxes.push_back({"Car", {i % 5 + (i % 2 ? 0.0 : 3.0), 20, i % 2 == 0}});
  return log;
}

GroundTruth truth() {
  GroundTruth out;
  for (int i = 0; i < kInstants; ++i) {
    GroundTruth::Instant instant;
    instant.frame = i;
    instant.t = i * kStep;
    TruthObject car;
    car.frame = i;
    car.t = instant.t;
    car.id = 1;
    car.type = "Car";
    car.position = Vector3(10, 0, 0);
    car.length = 4, car.width = 2, car.height = 1.5;
    instant.objects.push_back(car);
    out.instants.push_back(instant);
  }
  return out;
}

/// The car with an existence of 0.9, a phantom beside it with that of `phantom`.
TrackedRun runWith(double phantom) {
  TrackedRun run;
  run.class_names = {"car"};
  for (int i = 0; i < kInstants; ++i) {
    Scene scene;
    scene.frame = i;
    scene.stamp = Stamp{} + i * kStep;
    for (const double existence : {0.9, phantom}) {
      SceneObject o;
      o.id = existence == phantom ? 2 : 1;
      o.class_id = 0;
      o.class_probability = {1};
      o.existence = existence;
      o.position = Vector3(10, o.id == 1 ? 0 : 8, 0);
      o.length = 4, o.width = 2, o.height = 1.5;
      scene.objects.push_back(o);
    }
    run.scenes.push_back(scene);
  }
  return run;
}

ConfidenceInput inputOf(std::vector<double> phantoms) {
  ConfidenceInput input;
  input.sensor = "boxes";
  input.names = {{"Car", "car"}};
  input.clutter_per_scan = 4;
  for (std::size_t i = 0; i < phantoms.size(); ++i) {
    input.logs.push_back(boxes(i ? "b" : "a"));
    input.truths.push_back(truth());
  }
  input.evaluation.selection.min_points = 0;
  input.evaluation.exclusion = input.evaluation.tolerance;
  input.track = [phantoms](std::size_t log, const ScoreKeys&) { return runWith(phantoms[log]); };
  return input;
}

TEST(ConfidenceStudy, TheThresholdExcludesPhantomsAndKeepsObjects) {
  const StudyReport report = confidenceStudy(inputOf({0.62, 0.38}), "mine.ini");
  const std::string& ini = report.files.at(0).second;
  EXPECT_NE(ini.find("include = mine.ini\n"), std::string::npos) << ini;
  EXPECT_NE(ini.find("min_existence = 0.65\n"), std::string::npos) << ini;
  EXPECT_NE(ini.find("confidence = fitted\nscore_slope.car = "), std::string::npos) << ini;
}

TEST(ConfidenceStudy, WhatStandsWhereTheTruthLabelsNothingIsNotFalse) {
  ConfidenceInput input = inputOf({0.62});
  for (int i = 0; i < kInstants; ++i) {
    TruthObject place;
    place.frame = i;
    place.t = i * kStep;
    place.type = kAreaType;
    place.position = Vector3(10, 8, 0);
    place.length = 4, place.width = 2, place.height = 1.5;
    place.ignore = true;
    input.logs[0].unlabeled.push_back(place);
  }
  const StudyReport report = confidenceStudy(input, "mine.ini");
  for (const auto& row : report.tables.at(1).rows) EXPECT_EQ(row.at(5), "0") << row.at(1);
  const auto before = confidenceStudy(inputOf({0.62}), "mine.ini").tables.at(1).rows;
  EXPECT_EQ(before.front().at(5), std::to_string(kInstants));
}

TEST(ConfidenceStudy, ALogsOwnFiguresAreAtTheThresholdOfTheOthers) {
  const auto rows = confidenceStudy(inputOf({0.62, 0.38}), "mine.ini").tables.at(0).rows;
  EXPECT_EQ(rows[0][1], "0.40");
  EXPECT_EQ(rows[0][2], "0.00") << "the other log's threshold lets its phantom pass";
  EXPECT_EQ(rows[1][1], "0.65");
  EXPECT_EQ(rows[1][2], "100.00");
}

TEST(ConfidenceStudy, TheBalanceIsThatOfObjectsAScanToTheInisClutter) {
  const std::string ini = confidenceStudy(inputOf({0.62, 0.38}), "mine.ini").files.at(0).second;
  EXPECT_NE(ini.find("score_balance.car = -1.39\n"), std::string::npos) << ini;  // log(1 / 4)
}

TEST(ConfidenceStudy, EachLogIsTrackedWithWhatTheOthersTaught) {
  ConfidenceInput input = inputOf({0.62, 0.38});
  for (BoxWithTruth& b : input.logs[1].boxes) b.sample.score *= 10;  // another scale
  std::vector<double> slopes(2);
  input.track = [&](std::size_t log, const ScoreKeys& keys) {
    slopes[log] = std::stod(keys.at(0).second);
    return runWith(0.5);
  };
  confidenceStudy(input, "mine.ini");
  EXPECT_GT(slopes[1], 4 * slopes[0]) << "of the first log, whose scores are small";
}

TEST(ConfidenceStudy, RefusesLogsWithoutBoxes) {
  EXPECT_THROW(confidenceStudy(ConfidenceInput{}, "mine.ini"), DataError);
}

}  // namespace
}  // namespace perception
