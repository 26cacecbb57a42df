#include "studies/resolution/ResolutionReport.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libperception/core/math/Random.h"
#include "libperception/measurement/models/CameraResolution.h"
#include "studies/resolution/ResolutionFigures.h"

namespace perception {
namespace {

constexpr int kScans = 400;

TruthObject standing(std::int64_t frame, std::int64_t id, const char* type, double x, double y) {
  TruthObject o;
  o.frame = frame;
  o.t = 0.1 * static_cast<double>(frame);
  o.id = id;
  o.type = type;
  o.position = {x, y, 0};
  o.length = o.width = 0.5, o.height = 1.7;
  return o;
}

/// A detector that finds `recall` of the cars within `range` [m] and none beyond, and one more box
/// on nothing in every fifth scan.
MeasurementRun seenBy(double range, double recall, GroundTruth& truth) {
  MeasurementRun run;
  run.class_names = {"pedestrian", "car"};
  RecordedSensor sensor;
  sensor.label = "CAMERA";
  sensor.modality = Modality::kCamera;
  sensor.range_max = 1.2 * range;
  sensor.labels = {"car", "person"};
  sensor.class_range = {range, range};
  run.sensors = {sensor};
  Rng rng({7, static_cast<std::uint64_t>(range), 0, 0});
  truth = {};
  for (int k = 0; k < kScans; ++k) {
    RecordedScan scan;
    scan.frame = k;
    scan.stamp = Stamp::fromSeconds(0.1 * k);
    truth.instants.push_back({k, 0.1 * k, {}});
    const auto add = [&](double x, double y) {
      RecordedMeasurement m;
      m.label = "car";
      m.position = {x, y};
      m.range = std::hypot(x, y);
      m.sd_range = m.sd_across = 0.05;
      scan.measurements.push_back(m);
    };
    for (int i = 0; i < 8; ++i) {
      const double angle = kTwoPi * (i + 0.5) / 8, d = range * rng.uniform(0.2, 1.59);
      const double x = d * std::cos(angle), y = d * std::sin(angle);
      truth.instants.back().objects.push_back(standing(k, i + 1, "Car", x, y));
      if (d < range && rng.uniform() < recall) add(x, y);
    }
    if (k % 5 == 0) add(0.1 * range, 0);
    run.scans.push_back(std::move(scan));
  }
  return run;
}

TEST(ResolutionFigures, RecallOverTheRangeDoesNotDependOnTheRange) {
  for (const CameraResolution& row : cameraResolutions()) {
    if (row.car_range < 10) continue;  // objects of this test would hide each other
    GroundTruth truth;
    const MeasurementRun run = seenBy(row.car_range, 0.85, truth);
    const RangeRates rates = rangeRates(run, "CAMERA", truth, {row.car_range, row.person_range},
                                        {{{"car"}, {"person"}}});
    const auto in_view = static_cast<double>(rates.within(0, 0, .9).in_view);
    ASSERT_GT(in_view, 1000);
    // Four standard errors.
    EXPECT_NEAR(*rates.recallIn(0, 0, .9), 0.85, 4 * std::sqrt(.85 * .15 / in_view)) << row.name;
    EXPECT_EQ(*rates.recallIn(0, 1.1, 1.6), 0) << row.name;
    EXPECT_FALSE(rates.recallIn(1, 0, 1.6));  // no persons
    EXPECT_NEAR(*rates.halfRange(0) / row.car_range, 1, 0.1) << row.name;
    // One in five scans has a box on nothing.
    const auto& p = rates.precision[0];
    EXPECT_EQ(p.measurements - p.right_class, static_cast<std::size_t>(kScans / 5));
  }
}

TEST(ResolutionFigures, DetectionsAreCountedPerScanAndKind) {
  GroundTruth truth;
  MeasurementRun run = seenBy(30, 1, truth);
  for (RecordedScan& scan : run.scans) {
    RecordedMeasurement person;
    person.label = "person";
    person.range = 4;
    scan.measurements.push_back(person);
  }
  const DetectionCounts counts = detectionCounts(run, "CAMERA", {{{"car"}, {"person"}}});
  EXPECT_EQ(counts.scans, kScans);
  EXPECT_EQ(counts.mean(1), 1);
  EXPECT_NEAR(counts.mean(), counts.mean(0) + 1, 1e-12);
  EXPECT_EQ(counts.reach(1), 4);
  EXPECT_LT(*counts.reach(0), 30);
  EXPECT_GT(*counts.reach(0), 25);
}

TEST(ResolutionReport, PutsThePapersRatesBesideTheRunOfThatName) {
  ResolutionData data;
  data.source = "simulated";
  data.camera = "CAMERA";
  ResolutionRun run;
  run.name = "C-2k+R";
  run.resolution = 1;
  data.truth.emplace();
  run.measurements = seenBy(15, 0.85, *data.truth);
  run.tracks.class_names = run.measurements.class_names;
  data.runs.push_back(std::move(run));
  const StudyReport report = resolutionReport(data);
  const auto table = [&](const char* name) {
    return *std::find_if(report.tables.begin(), report.tables.end(),
                         [&](const StudyTable& t) { return t.name == name; });
  };
  EXPECT_EQ(table("tracking_rate").rows[0][4], "42.86");
  EXPECT_EQ(table("detection_rate").rows[0][0], "C-2k");
  EXPECT_EQ(table("detection_rate").rows[0][4], "1.98");
  EXPECT_EQ(table("resolutions").rows[0][3], "15");
  for (const StudyTable& t : report.tables) {
    for (const auto& row : t.rows) EXPECT_EQ(row.size(), t.columns.size()) << t.name;
  }
}

}  // namespace
}  // namespace perception
