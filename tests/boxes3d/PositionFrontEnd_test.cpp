#include "libperception/boxes3d/PositionFrontEnd.h"

#include <gtest/gtest.h>

#include <cmath>

namespace perception {
namespace {

ClassTable classes() {
  ClassTable table;
  for (const char* name : {"pedestrian", "cyclist", "static-other"}) {
    ObjectClass c;
    c.name = name;
    table.classes.push_back(c);
  }
  return table;
}

DetectionModel detection_model() {
  DetectionParams p;
  p.range_max = 50;
  p.fov = kPi;
  ClassDetection walker, rider, thing;
  walker.labels = {{"person", 0.9}, {"cyclist", 0.1}};
  walker.full_range = 20;
  walker.last_range = 40;
  rider.labels = {{"person", 0.2}, {"cyclist", 0.8}};
  thing.labels = {{"person", 0.5}, {"cyclist", 0.5}};
  return DetectionModel(p, {walker, rider, thing}, {"person", "cyclist"});
}

PositionParams positionParams() {
  PositionParams p;
  p.labels = {"person", "cyclist"};
  p.names = {"Pedestrian=person", "Cyclist=cyclist"};
  p.score_slope = {{"person", 2}, {"cyclist", 2}};
  p.score_offset = {{"person", 1}, {"cyclist", 1}};
  p.score_balance = {{"person", -0.5}, {"cyclist", -0.5}};
  p.off_label_score_weight = 0.25;
  p.group_distance = 0.8;
  p.sizes = true;
  return p;
}

ObjectDetection boxAt(const char* label, double score, double x, double y) {
  ObjectDetection o;
  o.label = label;
  o.score = score;
  o.space_box = ObjectDetection::SpaceBox{{x, y, 0.2}, 0.3, 1.0, 0.6, 1.7};
  return o;
}

MeasurementScan extract(const PositionParams& p, std::vector<ObjectDetection> boxes) {
  SensorFrame frame;
  ObjectDetections detections;
  detections.objects = std::move(boxes);
  frame.data = std::move(detections);
  return PositionFrontEnd(p, classes(), detection_model()).extract(frame);
}

TEST(PositionFrontEnd, ScoreSpeaksForTheLabelsOwnClassALittleForOthersAndNotForThings) {
  const auto scan = extract(positionParams(), {boxAt("Pedestrian", 2.0, 10, 0)});
  ASSERT_EQ(scan.measurements.size(), 1U);
  const Measurement& m = scan.measurements[0];
  const double ratio = 2 * (2.0 - 1.0) + 0.5;
  ASSERT_EQ(m.log_class.size(), 3U);
  EXPECT_NEAR(m.log_class[0], std::log(0.9) + ratio, 1e-12);
  EXPECT_NEAR(m.log_class[1], std::log(0.2) + 0.25 * ratio, 1e-12);
  EXPECT_NEAR(m.log_class[2], std::log(0.5), 1e-12);
  EXPECT_NEAR(m.log_clutter, std::log(0.5), 1e-12);
}

TEST(PositionFrontEnd, ALabelThatIsNoClassesNameSpeaksForAllRoadUsersAlike) {
  PositionParams p = positionParams();
  p.labels = {"person", "cyclist", "unknown"};
  p.names.push_back("unknown=unknown");
  p.score_slope.emplace_back("unknown", 2);
  p.score_offset.emplace_back("unknown", 1);
  p.score_balance.emplace_back("unknown", -0.5);
  const DetectionModel two = detection_model();
  const DetectionModel three(two.params(), {two.row(0), two.row(1), two.row(2)}, p.labels);
  SensorFrame frame;
  ObjectDetections detections;
  detections.objects = {boxAt("unknown", 2.0, 10, 0)};
  frame.data = std::move(detections);
  const auto scan = PositionFrontEnd(p, classes(), three).extract(frame);
  ASSERT_EQ(scan.measurements.size(), 1U);
  const Measurement& m = scan.measurements[0];
  const double ratio = 2 * (2.0 - 1.0) + 0.5;
  EXPECT_NEAR(m.log_class[0], m.log_class[1], 1e-12);
  EXPECT_NEAR(m.log_class[0] - m.log_class[2], ratio, 1e-12);  // but not for things
}

TEST(PositionFrontEnd, OddsFallWithTheRangeAndStayWithinTheLimit) {
  PositionParams p = positionParams();
  p.score_fade = {{"person", 0.05}};
  const auto scan =
      extract(p, {boxAt("Pedestrian", 2.0, 10, 0), boxAt("Pedestrian", 100.0, 30, 0)});
  ASSERT_EQ(scan.measurements.size(), 2U);
  EXPECT_NEAR(scan.measurements[0].log_class[0], std::log(0.9) + 2 + 0.5 - 0.5, 1e-12);
  EXPECT_NEAR(scan.measurements[1].log_class[0], std::log(0.9) + p.score_limit, 1e-12);
}

TEST(PositionFrontEnd, TwoLabelsOnOneCyclistAreOneMeasurementOfTheSurerBox) {
  const auto scan = extract(
      positionParams(),
      {boxAt("Pedestrian", 1.2, 10, 0), boxAt("Cyclist", 3, 10.3, 0), boxAt("Cyclist", 2, 14, 0)});
  ASSERT_EQ(scan.measurements.size(), 2U);
  EXPECT_EQ(scan.measurements[0].label, 1);
  EXPECT_EQ(scan.measurements[0].detection, 1);
  EXPECT_NEAR(scan.measurements[0].z.x(), 10.3, 1e-12);
}

TEST(PositionFrontEnd, TwoBoxesOfOneLabelStayTwo) {
  EXPECT_EQ(extract(positionParams(), {boxAt("Cyclist", 2, 10, 0), boxAt("Cyclist", 3, 10.3, 0)})
                .measurements.size(),
            2U);
}

TEST(PositionFrontEnd, AnUnsureBoxIsLessPrecise) {
  PositionParams p = positionParams();
  p.clutter_sigma_growth = 3;
  const auto scan = extract(p, {boxAt("Pedestrian", 9, 10, 0), boxAt("Pedestrian", -9, 10, 5)});
  ASSERT_EQ(scan.measurements.size(), 2U);
  const double sure = scan.measurements[0].R(0, 0), unsure = scan.measurements[1].R(0, 0);
  EXPECT_NEAR(sure, p.sigma * p.sigma + 0.05 * 0.05, 1e-3);
  EXPECT_NEAR(unsure, 16 * p.sigma * p.sigma + 0.05 * 0.05, 1e-2);
}

TEST(PositionFrontEnd, BoxesTellSizesAxisAndHeights) {
  PositionParams p = positionParams();
  p.length_excess = {{"person", 0.2}};
  const auto scan = extract(p, {boxAt("Pedestrian", 2, 10, 0)});
  const Measurement& m = scan.measurements.at(0);
  ASSERT_TRUE(m.sides && m.heading && m.base_z && m.height);
  EXPECT_NEAR(m.sides->length, 0.8, 1e-12);
  EXPECT_NEAR(m.sides->width, 0.6, 1e-12);
  EXPECT_NEAR(m.heading->yaw, 0.3, 1e-12);
  EXPECT_NEAR(m.base_z->mean, 0.2, 1e-12);
  EXPECT_NEAR(m.height->mean, 1.7, 1e-12);
}

TEST(PositionFrontEnd, UnknownLabelsAndBrokenBoxesAreCounted) {
  ObjectDetection broken = boxAt("Cyclist", 2, 10, 0);
  broken.space_box->length = std::nan("");
  const auto scan = extract(
      positionParams(),
      {boxAt("Tram", 2, 10, 0), broken, boxAt("Cyclist", 2, -10, 0), boxAt("Cyclist", 2, 60, 0)});
  EXPECT_TRUE(scan.measurements.empty());
  EXPECT_EQ(scan.dropped, 4U);
}

TEST(PositionModel, DetectionFallsFromFullToLastRange) {
  const auto scan = extract(positionParams(), {boxAt("Pedestrian", 2, 10, 0)});
  const auto at = [&](double x) {
    Kinematics k;
    k.q << x, 0, 0, 0, 0;
    return scan.model->detectionProbability(0, k, Extent{}, scan.state, 1);
  };
  EXPECT_NEAR(at(10), 0.9, 1e-12);
  EXPECT_NEAR(at(30), 0.45, 1e-12);
  EXPECT_EQ(at(45), 0);
}

}  // namespace
}  // namespace perception
