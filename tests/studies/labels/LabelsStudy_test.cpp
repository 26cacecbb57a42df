#include "studies/labels/LabelsStudy.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <map>

#include "libperception/boxes3d/PositionFrontEnd.h"
#include "libperception/config/Config.h"

namespace perception {
namespace {

const std::vector<std::string> kLabels = {"Car", "Pedestrian", "Cyclist"};

ObjectDetection boxAt(const char* label, double score, double x, double y, double length = 0.8,
                      double width = 0.6, double height = 1.7) {
  ObjectDetection o;
  o.label = label;
  o.score = score;
  o.space_box = ObjectDetection::SpaceBox{{x, y, -1.7}, 0, length, width, height};
  return o;
}

// Things of one box each, far from each other.
ObjectDetections things(int n, const char* label = "Pedestrian") {
  ObjectDetections d;
  for (int i = 0; i < n; ++i) d.objects.push_back(boxAt(label, 5, 10 * i, 0));
  return d;
}

TEST(CorruptLabels, HitsTheShareAskedForAndFlipsToTheOthersAlike) {
  constexpr int kThings = 3000;
  ObjectDetections d = things(kThings);
  corruptLabels({LabelNoise::kFlipped, 0.3}, kLabels, 0.8, {7, 1, 0, 0}, d);
  std::map<std::string, int> count;
  for (const auto& o : d.objects) ++count[o.label];
  // Four deviations of a binomial count.
  EXPECT_NEAR(count["Pedestrian"], 0.70 * kThings, 4 * std::sqrt(0.7 * 0.3 * kThings));
  EXPECT_NEAR(count["Car"], 0.15 * kThings, 4 * std::sqrt(0.15 * 0.85 * kThings));
  EXPECT_NEAR(count["Cyclist"], 0.15 * kThings, 4 * std::sqrt(0.15 * 0.85 * kThings));
}

TEST(CorruptLabels, WhatASmallShareHitsALargerOneHits) {
  ObjectDetections few = things(500), many = things(500);
  corruptLabels({LabelNoise::kDropped, 0.1}, kLabels, 0.8, {7, 1, 0, 0}, few);
  corruptLabels({LabelNoise::kDropped, 0.4}, kLabels, 0.8, {7, 1, 0, 0}, many);
  int hit = 0;
  for (std::size_t i = 0; i < few.objects.size(); ++i) {
    if (few.objects[i].label != kNoLabel) continue;
    ++hit;
    EXPECT_EQ(many.objects[i].label, kNoLabel);
  }
  EXPECT_GT(hit, 20);
}

TEST(CorruptLabels, AThingThatIsHitKeepsItsSurestBoxAlone) {
  ObjectDetections d;
  d.objects = {boxAt("Cyclist", 1, 10, 0), boxAt("Pedestrian", 4, 10.3, 0), boxAt("Car", 2, 30, 0)};
  corruptLabels({LabelNoise::kDropped, 1}, kLabels, 0.8, {1, 1, 0, 0}, d);
  ASSERT_EQ(d.objects.size(), 2U);
  EXPECT_EQ(d.objects[0].label, kNoLabel);
  EXPECT_EQ(d.objects[0].score, 4);
  EXPECT_EQ(d.objects[0].space_box->bottom_center.x(), 10.3);
  EXPECT_EQ(d.objects[1].label, kNoLabel);
}

TEST(CorruptLabels, NothingChangesWithoutNoiseNorImageBoxesEver) {
  ObjectDetections d = things(3);
  d.objects[1].space_box.reset();
  ObjectDetections undamaged = d;
  corruptLabels({LabelNoise::kFlipped, 0}, kLabels, 0.8, {1, 1, 0, 0}, undamaged);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(undamaged.objects[i].label, "Pedestrian");
  corruptLabels({LabelNoise::kFlipped, 1}, kLabels, 0.8, {1, 1, 0, 0}, d);
  EXPECT_NE(d.objects[0].label, "Pedestrian");
  EXPECT_EQ(d.objects[1].label, "Pedestrian");
}

TEST(KeepLabel, TakesBoxesWithoutALabelOnlyWhenAskedTo) {
  ObjectDetections d;
  d.objects = {boxAt("Car", 1, 0, 0), boxAt(kNoLabel, 1, 9, 0), boxAt("Cyclist", 1, 20, 0)};
  ObjectDetections with = d;
  keepLabel("Car", false, d);
  ASSERT_EQ(d.objects.size(), 1U);
  EXPECT_EQ(d.objects[0].label, "Car");
  keepLabel("Car", true, with);
  EXPECT_EQ(with.objects.size(), 2U);
}

// A walker who crosses and a car that drives off, for two seconds at ten frames, without noise.
Vector2 walkerAt(double t) { return {12, -3 + 1.4 * t}; }
Vector2 carAt(double t) { return {15 + 5 * t, 4}; }

RecordedLog streetLog(const LabeledLog::Edit& edit) {
  Config config = Config::fromFile(PERCEPTION_SOURCE_DIR "/ini/kitti-detections-unlabelled.ini");
  RecordedLog log;
  log.name = "street";
  log.simulated = true;
  log.model.classes = readClassTable(config);
  log.model.params = config.read<FilterParams>("filter");
  log.model.proposal = Proposal::kRanked;
  log.particles.sample_size = 8;
  log.scene = config.read<SceneParams>("scene");
  const auto front_end = makePositionFrontEnd(config, "pointrcnn", log.model.classes);
  for (int k = 0; k < 20; ++k) {
    const double t = 0.1 * k;
    SensorFrame frame;
    frame.sensor = "pointrcnn";
    frame.frame = k;
    frame.stamp = frame.ego.stamp = Stamp::fromSeconds(1000 + t);
    frame.T_ego_sensor.translation().z() = 1.73;
    ObjectDetections d;
    d.objects = {boxAt("Pedestrian", 6, walkerAt(t).x(), walkerAt(t).y()),
                 boxAt("Car", 9, carAt(t).x(), carAt(t).y(), 4.2, 1.7, 1.5)};
    edit(d, frame.stamp);
    frame.data = d;
    const auto scan = std::make_shared<const MeasurementScan>(front_end->extract(frame));
    log.entries.push_back({RecordedLog::Entry::kScan, scan, {}, -1});
    log.entries.push_back({RecordedLog::Entry::kScene, nullptr, frame.ego, k});
  }
  log.first_stamp = Stamp::fromSeconds(1000);
  return log;
}

LabeledLog street() {
  LabeledLog log;
  log.name = "street";
  log.record = streetLog;
  for (int k = 0; k < 20; ++k) {
    GroundTruth::Instant instant;
    instant.frame = k;
    instant.t = 0.1 * k;
    const auto add = [&](std::int64_t id, const char* type, const Vector2& place) {
      TruthObject o;
      o.frame = k;
      o.t = instant.t;
      o.id = id;
      o.type = type;
      o.position = {place.x(), place.y(), 0};
      instant.objects.push_back(o);
    };
    add(1, "Pedestrian", walkerAt(instant.t));
    add(2, "Van", carAt(instant.t));  // counts as a car
    add(3, "Truck", {30, -10});       // no label names it: missing it is no miss
    log.truth.instants.push_back(instant);
  }
  return log;
}

LabelsParams params() {
  LabelsParams p;
  p.shares = {0.5};
  p.last_measurement = 15;
  p.evaluation.selection.range = 40;
  return p;
}

// MOTA by class [%] of the rows with these labels, by method.
double motaOf(const StudyReport& report, const std::string& labels, const std::string& method) {
  for (const auto& row : report.tables[0].rows) {
    if (row[0] == labels && row[1] == method) return std::stod(row[2]);
  }
  ADD_FAILURE() << "no row " << labels << ", " << method;
  return 0;
}

TEST(LabelsStudy, GoodLabelsDoForEitherWayAndFlippedOnesNeedJointClassification) {
  const StudyReport report = labelsStudy(params(), {street()});
  EXPECT_EQ(report.data.rfind("simulated", 0), 0U);
  EXPECT_GT(motaOf(report, "as they are", "joint"), 90);
  EXPECT_GT(motaOf(report, "as they are", "tracker per class"), 90);
  EXPECT_GT(motaOf(report, "50 % dropped", "joint"),
            motaOf(report, "50 % dropped", "tracker per class, unlabeled to all"));
  EXPECT_GT(motaOf(report, "50 % flipped", "joint"),
            motaOf(report, "50 % flipped", "tracker per class"));
  // Both objects are measured in every frame, by a truth without the truck.
  EXPECT_EQ(report.tables[2].rows[0][2], "2");
  EXPECT_EQ(report.tables[2].rows[0].back(), "2");
}

TEST(LabelsStudy, DoesNotDependOnTheThreads) {
  const StudyReport many = labelsStudy(params(), {street(), street()});
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(markdownOf(many), markdownOf(labelsStudy(params(), {street(), street()})));
}

SceneObject object(std::uint64_t id, std::vector<double> p, double existence) {
  SceneObject o;
  o.id = id;
  o.class_probability = std::move(p);
  o.existence = existence;
  return o;
}

TEST(RoadUsers, ArePutOutByTheirProbabilityAndTakeTheLikeliestNamedClass) {
  TrackedRun run;
  run.class_names = {"pedestrian", "car", "bus", "static-other"};
  Scene scene;
  scene.objects = {object(1, {.1, .3, .5, .1}, .9), object(2, {.1, .2, .1, .6}, .99)};
  run.scenes = {scene};
  const std::vector<bool> road_user = {true, true, true, false};
  const TrackedRun out = roadUsers(run, road_user, {0, 1}, 0.5);
  ASSERT_EQ(out.scenes[0].objects.size(), 1U);
  EXPECT_EQ(out.scenes[0].objects[0].id, 1U);
  EXPECT_EQ(out.scenes[0].objects[0].class_id, 1);  // no label names the bus
  EXPECT_NEAR(out.scenes[0].objects[0].existence, .81, 1e-12);
  EXPECT_EQ(roadUsers(run, road_user, {0, 1}, 0.5, 0).scenes[0].objects[0].class_id, 0);
}

TEST(Joined, KeepsIdsApart) {
  TrackedRun run;
  Scene scene;
  scene.objects = {object(1, {1}, 1), object(2, {1}, 1)};
  run.scenes = {scene};
  const TrackedRun out = joined({run, run, run});
  ASSERT_EQ(out.scenes[0].objects.size(), 6U);
  for (std::size_t i = 1; i < 6; ++i)
    EXPECT_LT(out.scenes[0].objects[i - 1].id, out.scenes[0].objects[i].id);
}

}  // namespace
}  // namespace perception
