#include "libperception/calibration/detectors/DetectorStudy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

constexpr int kScans = 400;
constexpr double kNoise = 0.2, kStated = 0.4;  // [m] what errs, what is stated

TruthObject walker(std::int64_t frame, std::int64_t id, double x, double y) {
  TruthObject o;
  o.frame = frame, o.t = 0.1 * static_cast<double>(frame), o.id = id;
  o.type = "Pedestrian";
  o.position = {x, y, 0};
  o.length = o.width = 0.6, o.height = 1.7;
  return o;
}

/// Two walkers seen in three scans of four, one in ten of them under the other label, and clutter
/// far off in every second scan. `repeated`: errors stay with the object.
DetectorCounts counted(bool repeated, double stated = kStated) {
  RecordedLog log;
  log.model = test::exactModel(test::linearClasses());
  const auto sensor = std::make_shared<const PositionModel>(test::linearSensor());
  GroundTruth truth;
  Rng rng({5, 0, 0, 0});
  Vector2 kept[2] = {Vector2::Zero(), Vector2::Zero()};
  for (int k = 0; k < kScans; ++k) {
    GroundTruth::Instant instant;
    instant.frame = k, instant.t = 0.1 * k;
    std::vector<Measurement> boxes;
    for (int i = 0; i < 2; ++i) {
      const Vector2 place(5 + i, i == 0 ? -4 : 4);
      instant.objects.push_back(walker(k, i, place.x(), place.y()));
      if (k % 4 == 3) continue;
      if (!repeated || k % 100 == 0) kept[i] = {rng.normal(0, kNoise), rng.normal(0, kNoise)};
      Measurement m;
      m.z = place + kept[i];
      m.R = stated * stated * Matrix2::Identity();
      m.seen = 3;
      m.label = k % 10 == 0 ? 1 : 0;
      m.position = m.z;
      boxes.push_back(m);
    }
    if (k % 2 == 0) {
      Measurement m = boxes.empty() ? Measurement{} : boxes.front();
      m.z = Vector2(12, 0);
      m.R = stated * stated * Matrix2::Identity();
      m.seen = 3;
      m.label = 1;
      m.position = m.z;
      boxes.push_back(m);
    }
    auto scan = std::make_shared<MeasurementScan>(test::positionScan(sensor, 0.1 * k, {}));
    scan->sensor = "boxes";
    scan->frame = k;
    scan->measurements = boxes;
    RecordedLog::Entry entry;
    entry.scan = scan;
    log.entries.push_back(entry);
    truth.instants.push_back(instant);
  }
  std::map<std::string, DetectorCounts> counts;
  countDetections(log, truth, 0, {{"boxes", 2}}, counts);
  return counts.at("boxes");
}

ErrorFigures rangeOf(const DetectorCounts& counts) {
  std::vector<const DetectorError*> some;
  for (const DetectorError& e : counts.errors)
    if (e.quantity == "range") some.push_back(&e);
  return figuresOf(some);
}

TEST(DetectorCounts, FindDetectionLabelsClutterAndBirths) {
  const DetectorCounts counts = counted(false);
  EXPECT_EQ(counts.scans, 400U);
  EXPECT_EQ(counts.first_seen, 2U);
  ASSERT_EQ(counts.chances.size(), 800U);
  const auto with = [&](int label) {
    return std::count_if(counts.chances.begin(), counts.chances.end(),
                         [&](const auto& c) { return c.label == label; });
  };
  EXPECT_EQ(with(-1), 200);
  EXPECT_EQ(with(1), 80);  // tens are no scans of the fourth kind: 40 of them, both walkers
  EXPECT_EQ(counts.clutter[1], 200U);
  EXPECT_EQ(counts.clutter[0], 0U);
}

TEST(DetectorCounts, NoiseIsHeldAgainstWhatIsStated) {
  const ErrorFigures f = rangeOf(counted(false));
  ASSERT_EQ(f.count, 600U);
  // The mean square of n normal errors has a relative deviation of sqrt(2 / n).
  EXPECT_NEAR(f.nis, kNoise * kNoise / (kStated * kStated), 4 * std::sqrt(2.0 / 600) * 0.25);
  EXPECT_NEAR(f.stated, kStated, 1e-9);
  EXPECT_NEAR(f.repeated, 0, 4 / std::sqrt(600.0));
}

TEST(DetectorCounts, ErrorsThatStayWithTheObjectAreRepeated) {
  EXPECT_GT(rangeOf(counted(true)).repeated, 0.7);
}

TEST(DetectorStudy, WritesTheCountedKeysAsSections) {
  DetectorStudyInput input;
  input.classes = test::linearClasses();
  input.labels["boxes"] = {"person", "thing"};
  input.logs = "made up";
  const StudyReport report = detectorStudy(input, {{"boxes", counted(false)}});
  const std::string& ini = report.files.at(0).second;
  EXPECT_NE(ini.find("[sensor.boxes]\nclutter_per_scan = 0.5 "), std::string::npos) << ini;
  EXPECT_NE(ini.find("births_per_scan = 0.005 "), std::string::npos) << ini;
  EXPECT_NE(ini.find("[sensor.boxes.class.pedestrian]\ndetection = 0.75 "), std::string::npos);
  EXPECT_EQ(report.tables.size(), 4U);
}

TEST(DetectorStudy, GainsAreTheKeysThatTheCountsContradict) {
  DetectorStudyInput input;
  input.classes = test::linearClasses();
  input.labels["boxes"] = {"person", "thing"};
  input.include = "/somewhere/site.ini";
  DetectionParams stated;
  stated.clutter_per_scan = 0.5;  // as counted
  stated.births_per_scan = 0.4;   // two objects in 400 scans
  input.stated["boxes"] = stated;
  const StudyReport report = detectorStudy(input, {{"boxes", counted(false)}});
  ASSERT_EQ(report.files.at(0).first, "gains.ini");
  const std::string& ini = report.files[0].second;
  EXPECT_NE(ini.find("include = /somewhere/site.ini\n"), std::string::npos) << ini;
  EXPECT_EQ(ini.find("clutter_per_scan"), std::string::npos) << ini;
  EXPECT_NE(ini.find("births_per_scan = 0.005 "), std::string::npos) << ini;
}

TEST(DetectorStudy, NoiseAboveWhatIsStatedIsWrittenAndSmallerNoiseIsNot) {
  DetectorStudyInput input;
  input.classes = test::linearClasses();
  input.labels["boxes"] = {"person", "thing"};
  input.include = "/somewhere/site.ini";
  input.stated["boxes"] = {};
  const auto iniOf = [&](double stated) {
    return detectorStudy(input, {{"boxes", counted(false, stated)}}).files.at(0).second;
  };
  EXPECT_EQ(iniOf(2 * kNoise).find("noise_scale"), std::string::npos);
  const std::string ini = iniOf(kNoise / 2);
  const auto at = ini.find("noise_scale = ");
  ASSERT_NE(at, std::string::npos) << ini;
  EXPECT_NEAR(std::stod(ini.substr(at + 14)), 2, 0.15);
}

/// What a scan at 1 m of a wall says of the object behind it.
TEST(DetectorCounts, WhatHidesObjectsIsKnownFromTheScansWhereLabelsDoNotSay) {
  RecordedLog log;
  log.model = test::exactModel(test::linearClasses());
  const auto sensor = std::make_shared<const PositionModel>(test::linearSensor());
  GroundTruth truth;
  for (int k = 0; k < 3; ++k) {  // without a map, with an open one, behind a wall
    auto scan = std::make_shared<MeasurementScan>(test::positionScan(sensor, 0.1 * k, {}));
    scan->sensor = "boxes";
    scan->frame = k;
    if (k > 0) {
      auto map = std::make_shared<OcclusionMap>(Vector2::Zero(), 360);
      for (int i = -60; k == 2 && i <= 60; ++i)
        map->add({std::cos(radians(i)), std::sin(radians(i))});
      scan->occlusion = map;
    }
    RecordedLog::Entry entry;
    entry.scan = scan;
    log.entries.push_back(entry);
    GroundTruth::Instant instant;
    instant.frame = k, instant.t = 0.1 * k;
    instant.objects.push_back(walker(k, 1, 10, 0));
    instant.objects[0].occluded = 3;
    truth.instants.push_back(instant);
  }
  std::map<std::string, DetectorCounts> counts;
  countDetections(log, truth, 0, {{"boxes", 2}}, counts);
  const auto& chances = counts.at("boxes").chances;
  ASSERT_EQ(chances.size(), 2U);
  EXPECT_EQ(chances[0].occluded, 0);
  EXPECT_EQ(chances[1].occluded, 2);
}

TEST(DetectorStudy, RefusesLogsWithoutDetections) {
  EXPECT_THROW(detectorStudy({}, {}), DataError);
}

}  // namespace
}  // namespace perception
