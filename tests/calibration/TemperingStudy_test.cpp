#include "libperception/calibration/TemperingStudy.h"

#include <gtest/gtest.h>

#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

constexpr double kRight = 0.8;  // P(label of its class)

/// Cars and persons that stand on a grid, each seen in every scan with a label that is right with
/// probability .8: drawn anew every scan, or once for all.
TemperingLog gridLog(bool same_label, std::uint64_t seed) {
  ClassTable classes = test::linearClasses();
  classes.classes[0] = classes.classes[1];
  classes.classes[0].name = "pedestrian";
  classes.classes[1].name = "car";
  for (auto& c : classes.classes) c.prior = 0.5;
  PositionModel::Params sensor = test::linearSensor();
  sensor.classes[1] = sensor.classes[0];
  sensor.classes[0].detection = sensor.classes[1].detection = 0.95;
  sensor.classes[0].labels = {kRight, 1 - kRight};
  sensor.classes[1].labels = {1 - kRight, kRight};
  sensor.clutter_per_scan = 0.1;
  const auto model = std::make_shared<const PositionModel>(sensor);

  TemperingLog out;
  out.log.name = "grid";
  out.log.simulated = true;
  out.log.model = test::exactModel(classes);
  out.log.particles.sample_size = 1;
  out.log.first_stamp = Stamp::fromSeconds(1000);
  Rng rng({seed, 0, 0, 0x7e3});
  constexpr int kObjects = 24, kScans = 15;
  std::vector<int> kind, first_label;
  const auto draw = [&](int k) { return rng.uniform() < kRight ? k : 1 - k; };
  for (int i = 0; i < kObjects; ++i) {
    kind.push_back(rng.uniform() < 0.5);
    first_label.push_back(draw(kind.back()));
  }
  for (int k = 0; k < kScans; ++k) {
    std::vector<test::LabeledPoint> points;
    GroundTruth::Instant instant;
    instant.frame = k;
    instant.t = 0.1 * k;
    for (int i = 0; i < kObjects; ++i) {
      const double x = 5.0 * (i % 6) - 12, y = 5.0 * (i / 6) - 8;
      const auto n = static_cast<std::size_t>(i);
      points.push_back({x + 0.1 * rng.normal(), y + 0.1 * rng.normal(),
                        same_label ? first_label[n] : draw(kind[n])});
      TruthObject o;
      o.frame = k;
      o.t = instant.t;
      o.id = i + 1;
      o.type = kind[n] ? "Car" : "Pedestrian";
      o.position = {x, y, 0};
      o.length = o.width = o.height = 1;
      instant.objects.push_back(o);
    }
    auto scan = test::positionScan(model, 0.1 * k, points);
    RecordedLog::Entry seen, scene;
    scene.kind = RecordedLog::Entry::kScene;
    scene.ego = scan.state.ego;
    scene.frame = k;
    seen.scan = std::make_shared<const MeasurementScan>(std::move(scan));
    out.log.entries.push_back(seen);
    out.log.entries.push_back(scene);
    out.truth.instants.push_back(instant);
  }
  return out;
}

TemperingParams everywhere() {
  TemperingParams p;
  p.proposal = Proposal::kNearest;
  p.particles = 1;
  p.evaluation.selection.fov = kTwoPi;
  return p;
}

double fittedLabel(bool same_label) {
  const std::vector<TemperingLog> logs = {gridLog(same_label, 1), gridLog(same_label, 2)};
  const StudyReport report = temperingStudy(everywhere(), logs);
  const StudyTable& found = report.tables.at(1);
  EXPECT_EQ(found.columns.back(), "POSITION label");
  return std::stod(found.rows.back().back());
}

TEST(Tempering, LabelsOfIndependentDrawsCountInFullAndRepeatedOnesHardly) {
  EXPECT_GT(fittedLabel(false), 0.6);
  EXPECT_LT(fittedLabel(true), 0.25);  // fifteen times the same label: about one of them
}

TEST(Tempering, TheFitIsScoredOnTheOtherLog) {
  const std::vector<TemperingLog> logs = {gridLog(true, 3), gridLog(true, 4)};
  const StudyReport report = temperingStudy(everywhere(), logs);
  const StudyTable& table = report.tables.at(0);
  const auto value = [&](std::size_t row, std::size_t column) {
    return std::stod(table.rows.at(row).at(column));
  };
  ASSERT_EQ(table.rows.size(), 9u);
  EXPECT_EQ(table.rows[2][0], "all");
  EXPECT_GT(value(8, 2), value(2, 2)) << "log likelihood, fitted against exponents of one";
  EXPECT_LT(value(8, 3), value(2, 3)) << "calibration error";
  EXPECT_NE(report.remarks.at(0).find("label_exponent"), std::string::npos);
}

TEST(Tempering, ExponentsOfARecordedLogAreThoseOfItsSensors) {
  const TemperingLog grid = gridLog(false, 5);
  Exponents e = exponentsOf(grid.log);
  ASSERT_EQ(e.sensors.size(), 1u);
  EXPECT_EQ(e.sensors[0].sensor, "POSITION");
  EXPECT_EQ(e.sensors[0].label, 1);
  EXPECT_EQ(e.kinematic, 1);
  e.sensors[0].label = 0.3;
  e.kinematic = 0.4;
  const Exponents back = exponentsOf(withExponents(grid.log, e));
  EXPECT_EQ(back.sensors[0].label, 0.3);
  EXPECT_EQ(back.kinematic, 0.4);
}

TEST(Tempering, OneLogIsTooFew) {
  EXPECT_THROW(temperingStudy(everywhere(), {gridLog(true, 1)}), DataError);
}

}  // namespace
}  // namespace perception
