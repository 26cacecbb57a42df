#include "libperception/calibration/clusters/ClusterSamples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/support/ClusterScenes.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

using test::SolidScene;

TruthObject truthBox(std::int64_t id, const std::string& type, const test::SolidBox& box) {
  TruthObject o;
  o.id = id, o.type = type;
  o.position = Vector3(box.center.x(), box.center.y(), 0);
  o.yaw = box.yaw, o.length = box.length, o.width = box.width, o.height = box.top;
  return o;
}

/// A van from the side, a person before it to the right, a wall behind to the left.
const test::SolidBox kVan{{12.9, 0}, kPi / 2, 4.4, 1.8, 0.25, 2},
    kPersonBox{{10, -4}, 0, 0.6, 0.6, 0, 1.8}, kWall{{25, 6}, kPi / 2, 6, 0.3, 0, 4};

SolidScene street() {
  SolidScene scene;
  scene.boxes = {kVan, kWall};
  scene.cylinders = {{kPersonBox.center, 0.25, 0, 1.75}};
  return scene;
}

/// A log of frames, its truth and its samples.
struct Log {
  LidarFrontEnd front_end = test::plainFrontEnd();
  GroundTruth truth;
  PointLabels labels{""};
  ClusterSamples samples;
  SampleRules rules;
  std::vector<SensorFrame> frames;

  void add(const SolidScene& scene, const Pose3& T_world_ego, std::vector<TruthObject> objects) {
    const auto number = static_cast<std::int64_t>(frames.size());
    SensorFrame frame = test::castScan(scene, test::narrowLidar(),
                                       Stamp::fromSeconds(50 + 0.1 * static_cast<double>(number)));
    frame.frame = number;
    frame.ego.T_world_ego = T_world_ego;
    for (TruthObject& o : objects) {
      o.frame = number;
      o.position = T_world_ego * o.position;
      o.yaw += yawOf(T_world_ego);
    }
    truth.instants.push_back({number, 0.1 * static_cast<double>(number), std::move(objects)});
    frames.push_back(std::move(frame));
  }
  void sample() {
    ClusterSampler sampler("LIDAR_TOP", front_end, truth, labels, 3, rules, samples);
    for (const SensorFrame& frame : frames) sampler.onFrame(frame);
  }
  /// The whole cluster nearest to a place of the ego frame.
  const ClusterSample& at(const Vector2& place, std::int64_t frame = 0) const {
    const ClusterSample* best = nullptr;
    for (const ClusterSample& s : samples.clusters) {
      if (s.whole >= 0 || s.frame != frame) continue;
      if (!best || (s.place - place).norm() < (best->place - place).norm()) best = &s;
    }
    if (!best) throw std::logic_error("no sample");
    return *best;
  }
};

const std::vector<TruthObject>& streetTruth() {
  static const std::vector<TruthObject> objects = {truthBox(5, "Van", kVan),
                                                   truthBox(9, "Pedestrian", kPersonBox)};
  return objects;
}

TEST(ClusterSamples, TypesOfTheTruthHaveKinds) {
  for (const char* type : {"Car", "Van", "Truck", "Bus", "Tram"})
    EXPECT_EQ(kindOfTruth(type), ClusterKind::kVehicle) << type;
  for (const char* type : {"Pedestrian", "Person_sitting"})
    EXPECT_EQ(kindOfTruth(type), ClusterKind::kPedestrian) << type;
  EXPECT_EQ(kindOfTruth("Cyclist"), ClusterKind::kCyclist);
  for (const char* type : {"Misc", "DontCare", "Animal", "car", ""})
    EXPECT_EQ(kindOfTruth(type), std::nullopt) << type;
}

TEST(ClusterSamples, BoxesNameTheirClustersAndTheRestAreThings) {
  Log log;
  const Pose3 pose = makePose(200, -30, 0, 2.5);
  log.add(street(), pose, streetTruth());
  log.sample();
  const ClusterSample &van = log.at({12, 0}), &person = log.at({10, -4}), &wall = log.at({25, 6});
  EXPECT_EQ(van.kind, ClusterKind::kVehicle);
  EXPECT_EQ(van.object, 5);
  EXPECT_EQ(person.kind, ClusterKind::kPedestrian);
  EXPECT_EQ(person.object, 9);
  EXPECT_EQ(wall.kind, ClusterKind::kThing);
  EXPECT_LT(wall.object, ClusterSample::kNoObject);
  EXPECT_EQ(van.log, 3u);
  EXPECT_EQ(van.frame, 0);
  EXPECT_LT((van.place - Vector2(12, 0)).norm(), 0.1);
  EXPECT_NEAR(static_cast<double>(van.descriptor[0]), 4.4, 0.15);
  const Vector2 sight =
      pose.translation().head<2>() - (pose * Vector3(van.place.x(), van.place.y(), 0)).head<2>();
  EXPECT_NEAR(van.view.bearing, std::atan2(sight.y(), sight.x()), 1e-9);
  EXPECT_NEAR(van.view.log_range, std::log(sight.norm()), 1e-9);
}

TEST(ClusterSamples, ObjectsKnowTheClusterThatShowsThemBest) {
  Log log;
  log.add(street(), Pose3::Identity(), streetTruth());
  log.sample();
  ASSERT_EQ(log.samples.objects.size(), 2u);
  const ObjectView& van = log.samples.objects[0];
  EXPECT_EQ(van.object, 5);
  EXPECT_EQ(van.kind, ClusterKind::kVehicle);
  EXPECT_NEAR(van.range, 12.9, 1e-9);
  EXPECT_GT(van.returns, 100u);
  EXPECT_GT(van.overlap, 0.95);
  EXPECT_EQ(&log.samples.clusters.at(static_cast<std::size_t>(van.sample)), &log.at({12, 0}));
}

TEST(ClusterSamples, AnObjectGrownTogetherWithAThingIsMixed) {
  Log log;
  SolidScene scene;
  scene.boxes = {kVan, {{12, 4.7}, kPi / 2, 4.6, 0.3, 0, 2}};  // a wall that goes on 0.2 m from it
  log.add(scene, Pose3::Identity(), {truthBox(5, "Van", kVan)});
  log.sample();
  EXPECT_EQ(log.at({12, 2}).kind, ClusterKind::kMixed);
  EXPECT_EQ(log.at({12, 2}).object, ClusterSample::kNoObject);
}

TEST(ClusterSamples, TypesWithoutAKindNameNothing) {
  Log log;
  log.add(street(), Pose3::Identity(), {truthBox(5, "Misc", kVan)});
  log.sample();
  EXPECT_EQ(log.at({12, 0}).kind, std::nullopt) << "it is no thing either";
  EXPECT_EQ(log.at({10, -4}).kind, ClusterKind::kThing);
  EXPECT_TRUE(log.samples.objects.empty());
}

TEST(ClusterSamples, OutsideOfTheCompleteFieldNothingIsAThing) {
  Log log;
  log.add(street(), Pose3::Identity(), {truthBox(9, "Pedestrian", kPersonBox)});
  log.rules.fov = radians(20);  // ends at 10 deg; the wall is at 13, the person at -22 deg
  log.sample();
  EXPECT_EQ(log.at({25, 6}).kind, std::nullopt);
  EXPECT_EQ(log.at({12, 0}).kind, ClusterKind::kThing);
  EXPECT_EQ(log.at({10, -4}).kind, ClusterKind::kPedestrian) << "a box tells it";
  EXPECT_TRUE(log.samples.objects.empty());
}

TEST(ClusterSamples, BeyondTheRangeNothingIsNamed) {
  Log log;
  log.add(street(), Pose3::Identity(), streetTruth());
  log.rules.range = 11.5;
  log.sample();
  EXPECT_EQ(log.at({12, 0}).kind, std::nullopt);
  EXPECT_EQ(log.at({25, 6}).kind, std::nullopt);
  EXPECT_EQ(log.at({10, -4}).kind, ClusterKind::kPedestrian);
  EXPECT_EQ(log.samples.objects.size(), 1u);
}

TEST(ClusterSamples, PartsReferToTheSampleOfTheirWhole) {
  Log log;
  SolidScene scene;
  scene.cylinders = {{{15, 1.64}, 0.25, 0, 1.75}, {{15, 2.36}, 0.25, 0, 1.75}};
  log.add(street(), Pose3::Identity(), {});
  log.add(scene, Pose3::Identity(), {truthBox(1, "Pedestrian", {{15, 1.64}, 0, 0.6, 0.6, 0, 1.8})});
  log.sample();
  int parts = 0, named = 0;
  for (const ClusterSample& s : log.samples.clusters) {
    if (s.whole < 0) continue;
    ++parts;
    const ClusterSample& whole = log.samples.clusters.at(static_cast<std::size_t>(s.whole));
    EXPECT_EQ(whole.frame, 1);
    EXPECT_NEAR(whole.place.y(), 2, 0.1);
    EXPECT_EQ(whole.kind, ClusterKind::kMixed);
    named += s.kind == ClusterKind::kPedestrian;
  }
  EXPECT_EQ(parts, 2);
  EXPECT_EQ(named, 1);
}

TEST(ClusterSamples, ThingsKeepTheirIdFromFrameToFrame) {
  Log log;
  for (int k = 0; k < 3; ++k) {  // the vehicle drives two meters a frame
    SolidScene scene;
    scene.boxes = {kVan, kWall};
    for (auto& box : scene.boxes) box.center.x() -= 2.0 * k;
    test::SolidBox van = kVan;
    van.center.x() -= 2.0 * k;
    log.add(scene, makePose(100 + 2.0 * k, 0, 0, 0), {truthBox(5, "Van", van)});
  }
  log.sample();
  const std::int64_t id = log.at({25, 6}, 0).object;
  EXPECT_LT(id, ClusterSample::kNoObject);
  EXPECT_EQ(log.at({23, 6}, 1).object, id);
  EXPECT_EQ(log.at({21, 6}, 2).object, id);
  EXPECT_EQ(log.at({8, 0}, 2).object, 5);
  EXPECT_NEAR(log.at({21, 6}, 2).t, 0.2, 1e-9);
}

TEST(ClusterSamples, AThingElsewhereIsAnotherOne) {
  Log log;
  SolidScene scene;
  scene.boxes = {kWall};
  log.add(scene, Pose3::Identity(), {});
  scene.boxes[0].center.x() += 1;
  log.add(scene, Pose3::Identity(), {});
  log.sample();
  EXPECT_NE(log.at({25, 6}, 0).object, log.at({26, 6}, 1).object);
}

TEST(ClusterSamples, FramesWithoutTruthAndOtherSensorsGiveNothing) {
  Log log;
  log.add(street(), Pose3::Identity(), streetTruth());
  log.frames[0].sensor = "OTHER";
  log.add(street(), Pose3::Identity(), streetTruth());
  log.truth.instants.pop_back();
  log.add(street(), Pose3::Identity(), streetTruth());
  log.frames[2].data = ObjectDetections{};
  log.sample();
  EXPECT_TRUE(log.samples.clusters.empty());
  EXPECT_TRUE(log.samples.objects.empty());
}

/// Labels of all returns of a frame by a rule of their place, sensor frame.
template <class Rule>
void labelBy(const Rule& rule, const test::TemporaryFolder& folder, Log& log) {
  std::filesystem::create_directory(folder / "a_Labels");
  const auto& cloud = std::get<LidarCloud>(log.frames[0].data);
  std::ofstream out(folder / "a_Labels/0.label", std::ios::binary);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::uint32_t label =
        rule(static_cast<double>(cloud.x[i]), static_cast<double>(cloud.y[i]));
    out.write(reinterpret_cast<const char*>(&label), sizeof label);
  }
  out.close();
  log.labels = PointLabels(folder / "a.rawlog");
}

TEST(ClusterSamples, LabelsOfPointsNameClustersInPlaceOfBoxes) {
  Log log;
  log.add(street(), Pose3::Identity(), {truthBox(1, "Car", kPersonBox)});
  const test::TemporaryFolder folder;
  constexpr std::uint32_t kMovingCar = 252, kPerson = 30, kBuilding = 50;
  labelBy(
      [&](double x, double y) {
        if (x > 20) return kBuilding;
        return y < -3 ? kPerson : kMovingCar;
      },
      folder, log);
  log.sample();
  EXPECT_EQ(log.at({12, 0}).kind, ClusterKind::kVehicle);
  EXPECT_EQ(log.at({10, -4}).kind, ClusterKind::kPedestrian);
  EXPECT_EQ(log.at({25, 6}).kind, ClusterKind::kThing);
}

TEST(ClusterSamples, WhatIsLabeledHalfOrNotAtAllIsNotNamed) {
  Log log;
  log.add(street(), Pose3::Identity(), {});
  const test::TemporaryFolder folder;
  labelBy([](double x, double y) { return x > 20 ? 0u : y > 0 ? 10u : 50u; }, folder, log);
  log.sample();
  EXPECT_EQ(log.at({12, 0}).kind, std::nullopt) << "half a car";
  EXPECT_EQ(log.at({25, 6}).kind, std::nullopt) << "unlabeled";
  EXPECT_EQ(log.at({10, -4}).kind, ClusterKind::kThing);
}

TEST(ClusterSamples, ReturnsOfNoSurfaceMakeAPhantom) {
  Log log;
  log.add(street(), Pose3::Identity(), {});
  const test::TemporaryFolder folder;
  constexpr std::uint32_t kCar = 10, kSpray = 114, kSnowOnTheGround = 111;
  labelBy(
      [&](double x, double y) {
        if (x > 20) return kSnowOnTheGround;
        return y < -3 ? kSpray : kCar;
      },
      folder, log);
  log.sample();
  EXPECT_EQ(log.at({12, 0}).kind, ClusterKind::kVehicle);
  EXPECT_EQ(log.at({10, -4}).kind, ClusterKind::kPhantom);
  EXPECT_EQ(log.at({25, 6}).kind, ClusterKind::kThing);
}

}  // namespace
}  // namespace perception
