#include "libperception/evaluation/front_ends/FrontEndEvaluation.h"

#include <gtest/gtest.h>

#include "libperception/core/Error.h"
#include "libperception/evaluation/tables/Report.h"
#include "tests/evaluation/MakeRun.h"

namespace perception {
namespace {

using namespace testing_evaluation;

// A lidar at the origin that looks along x and sees 50 m, and its scans of frames 0, 1, ...
MeasurementRun lidarRun(const std::vector<std::vector<RecordedMeasurement>>& scans) {
  MeasurementRun run;
  run.first_stamp = Stamp::fromSeconds(1000);
  run.class_names = {"pedestrian", "car", "static-other"};
  RecordedSensor lidar;
  lidar.label = "LIDAR";
  lidar.range_max = 50;
  lidar.labels = {"car_sized", "person_sized", "unstable"};
  lidar.class_range = {40, 50, 50};
  run.sensors = {lidar};
  for (std::size_t k = 0; k < scans.size(); ++k) {
    RecordedScan scan;
    scan.frame = static_cast<std::int64_t>(k);
    scan.stamp = Stamp::fromSeconds(1000 + 0.1 * static_cast<double>(k));
    scan.measurements = scans[k];
    run.scans.push_back(scan);
  }
  return run;
}

RecordedMeasurement seen(const std::string& label, double x, double y) {
  RecordedMeasurement m;
  m.label = label;
  m.position = {x, y};
  m.range = m.position.norm();
  m.sd_range = m.sd_across = 0.1;
  return m;
}

TruthObject thing(std::int64_t frame, const std::string& type, double x, double y, double length,
                  double width) {
  TruthObject object = makeTruth(frame, 1, x, y, type);
  object.length = length, object.width = width;
  object.ignore = type == "Misc";
  return object;
}

FrontEndEvaluation judge(const MeasurementRun& run, const std::vector<TruthObject>& truth,
                         FrontEndOptions options = {}) {
  return evaluateFrontEnd(run, "LIDAR", makeGroundTruth(truth), options);
}

TEST(FrontEnd, RecallIsOfObjectsTimesScans) {
  const auto f = judge(lidarRun({{seen("car_sized", 10, 0)}, {}}),
                       {thing(0, "Car", 10, 0, 4, 2), thing(1, "Car", 10, 0, 4, 2)});
  const RecallCounts r = f.recall({"car"}, true);
  EXPECT_EQ(r.in_view, 2u);
  EXPECT_EQ(r.found, 1u);
  EXPECT_EQ(r.named, 1u);
  EXPECT_EQ(f.scans, 2u);
}

TEST(FrontEnd, AFoundObjectIsNotNamedByAnotherLabel) {
  const auto f = judge(lidarRun({{seen("person_sized", 9, 0), seen("person_sized", 11, 0)}}),
                       {thing(0, "Car", 10, 0, 4, 2)});
  const RecallCounts r = f.recall({"car"}, true);
  EXPECT_EQ(r.found, 1u);
  EXPECT_EQ(r.named, 0u);
  EXPECT_EQ(r.measurements, 2u);  // it fell into two
}

TEST(FrontEnd, UnstableNamesACarButIsNoLabelOfThePaper) {
  const auto f = judge(lidarRun({{seen("unstable", 10, 0)}}), {thing(0, "Car", 10, 0, 4, 2)});
  EXPECT_EQ(f.recall({"car"}, true).named, 1u);
  EXPECT_EQ(f.recall({"car"}, true).named_primary, 0u);
}

TEST(FrontEnd, OnlyWhatTheSensorIsToSeeIsInView) {
  std::vector<TruthObject> truth = {thing(0, "Pedestrian", 45, 0, .5, .5),  // beyond its 40 m
                                    thing(0, "Car", 45, 0, 4, 2), thing(0, "Car", 60, 0, 4, 2)};
  const auto f = judge(lidarRun({{}}), truth);
  EXPECT_EQ(f.recall({"pedestrian"}, false).in_view, 0u);
  EXPECT_EQ(f.recall({"car"}, false).in_view, 1u);
}

TEST(FrontEnd, FewPointsAndHidingLeaveTheirDenominators) {
  std::vector<TruthObject> truth = {thing(0, "Car", 10, 0, 4, 2), thing(0, "Car", 20, 5, 4, 2)};
  truth[0].lidar_points = 5;
  truth[1].occluded = 3;
  const auto f = judge(lidarRun({{}}), truth);
  EXPECT_EQ(f.recall({"car"}, false).in_view, 1u);
  EXPECT_EQ(f.recall({"car"}, true).in_view, 0u);
}

TEST(FrontEnd, APoleIsOfAPersonsSizeButNoPerson) {
  FrontEndOptions options;
  options.surroundings = true;
  const auto f = judge(lidarRun({{seen("person_sized", 10, 0), seen("person_sized", 20, 0),
                                  seen("person_sized", 30, 0), seen("person_sized", 15, 15)}}),
                       {thing(0, "Misc", 10, 0, .2, .2), thing(0, "Misc", 20, 0, 3, 1),
                        thing(0, "Pedestrian", 30, 0, .5, .5)},
                       options);
  const PrecisionCounts p = f.precision("person_sized");
  EXPECT_EQ(p.measurements, 4u);
  EXPECT_EQ(p.right_class, 1u);
  EXPECT_EQ(p.right_size, 2u);
  EXPECT_EQ(p.on.at("Misc, person-sized"), 1u);
  EXPECT_EQ(p.on.at("Misc, larger"), 1u);
  EXPECT_EQ(p.on.at("Pedestrian"), 1u);
  EXPECT_EQ(p.on.at(kNothing), 1u);
}

TEST(FrontEnd, NothingIsWrongWhereTheTruthKnowsNothing) {
  FrontEndOptions options;
  options.selection.complete_fov = radians(80);
  const auto f = judge(lidarRun({{seen("car_sized", 10, 0), seen("car_sized", 0, 10)}}),
                       {thing(0, "Car", 30, 0, 4, 2)}, options);
  EXPECT_EQ(f.precision("car_sized").measurements, 1u);
}

TEST(FrontEnd, ARoughRangeMovesAMeasurementAlongTheSightAlone) {
  RecordedMeasurement rough = seen("car_sized", 14, 0), beside = seen("car_sized", 10, 3);
  rough.sd_range = beside.sd_range = 1;
  const auto f = judge(lidarRun({{rough, beside}}), {thing(0, "Car", 10, 0, 4, 2)});
  const PrecisionCounts p = f.precision("car_sized");
  EXPECT_EQ(p.right_class, 1u);
}

TEST(FrontEnd, CrownsAboveTheRoadAreNoObjects) {
  std::vector<TruthObject> truth = {thing(0, "Misc", 10, 0, 3, 3)};
  truth[0].position.z() = 2.5;
  const auto f = judge(lidarRun({{seen("person_sized", 10, 1)}}), truth);
  EXPECT_EQ(f.precision("person_sized").on.at(kNothing), 1u);
}

TEST(FrontEnd, RunsAdd) {
  auto f = judge(lidarRun({{seen("car_sized", 10, 0)}}), {thing(0, "Car", 10, 0, 4, 2)});
  f += judge(lidarRun({{seen("person_sized", 5, 0)}}), {thing(0, "Car", 10, 0, 4, 2)});
  EXPECT_EQ(f.recall({"car"}, true).in_view, 2u);
  EXPECT_EQ(f.recall({"car"}, true).found, 1u);
  EXPECT_EQ(f.precision("person_sized").measurements, 1u);
  EXPECT_EQ(f.scans, 2u);
  MeasurementRun other = lidarRun({{}});
  other.class_names = {"pedestrian", "bus", "static-other"};
  const auto strange = evaluateFrontEnd(other, "LIDAR", {}, {});
  EXPECT_THROW(f += strange, DataError);
}

TEST(FrontEnd, AnUnknownSensorIsAnErrorThatNamesTheKnownOnes) {
  try {
    evaluateFrontEnd(lidarRun({{}}), "RADAR_*", {}, {});
    FAIL();
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("LIDAR"), std::string::npos);
  }
}

TEST(FrontEnd, TablesStandBesideThePapers) {
  EvaluationReport report;
  EXPECT_TRUE(frontEndTables(report).empty());
  TrackedRun run = makeRun();
  report.runs.push_back({"run", "run", evaluate(run, {}, {})});
  report.runs[0].front_ends = {
      judge(lidarRun({{seen("car_sized", 10, 0)}}), {thing(0, "Car", 10, 0, 4, 2)})};
  const auto tables = frontEndTables(report);
  ASSERT_EQ(tables.size(), 4u);
  const auto& summary = tables[0];
  EXPECT_EQ(summary.rows[0][2], "100.0 %");
  EXPECT_EQ(summary.rows[0][4], "n/a");  // no surroundings in the truth
  bool paper = false;
  for (const auto& row : summary.rows)
    paper = paper || (row[1] == "Lidar, Sunny" && row[5] == "51 %");
  EXPECT_TRUE(paper);
  for (const auto& table : tables) {
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.header.size()) << table.title;
  }
}

TEST(Meaning, AClassNamesItself) {
  EXPECT_EQ(meaningOf("bus", {"car", "bus"}).classes, std::vector<std::string>{"bus"});
  EXPECT_TRUE(meaningOf("target", {"car"}).classes.empty());
}

}  // namespace
}  // namespace perception
