#include "libperception/lidar/LidarFrontEnd.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"
#include "tests/support/ClusterScenes.h"

namespace perception {
namespace {

using test::castScan;
using test::SolidScene;
using test::SpinningLidar;

LidarFrontEnd frontEnd(const LidarParams& params = {}, const DetectionParams& detection = {},
                       std::shared_ptr<const ClusterClassifier> classifier = nullptr) {
  ClassTable classes;
  classes.classes.resize(1);
  return LidarFrontEnd(
      params, classes,
      DetectionModel(detection, {ClassDetection{}}, LidarFrontEnd::labels(params.clusters)),
      std::move(classifier));
}

/// A car ahead to the left, a person ahead to the right, both alone.
SolidScene carAndPerson() {
  SolidScene scene;
  scene.boxes = {{{14, 4}, 0.5, 4.4, 1.8, 0.25, 1.5}};
  scene.cylinders = {{{10, -3}, 0.25, 0, 1.75}};
  return scene;
}

/// To which every cluster is a vehicle.
std::shared_ptr<const ClusterClassifier> alwaysVehicle() {
  BoostedTrees trees;
  trees.base = {0, 0, 5, 0, 0, 0};
  std::array<double, kClusterKinds> prior;
  prior.fill(1.0 / static_cast<double>(kClusterKinds));
  return std::make_shared<const ClusterClassifier>(trees, std::array<Calibration, kClusterKinds>{},
                                                   prior, EvidenceMemory{}, Provenance{});
}

const Measurement* withLabel(const MeasurementScan& scan, int label) {
  for (const Measurement& m : scan.measurements)
    if (m.label == label) return &m;
  return nullptr;
}

std::vector<Vector2> corners(const test::SolidBox& box) {
  std::vector<Vector2> result;
  for (const Vector2& sign : {Vector2(1, 1), Vector2(-1, 1), Vector2(-1, -1), Vector2(1, -1)})
    result.push_back(box.center +
                     rotate2(box.yaw, {sign.x() * box.length / 2, sign.y() * box.width / 2}));
  return result;
}

TEST(LidarFrontEnd, SeesACarAndAPersonAndNothingElse) {
  const MeasurementScan scan = frontEnd().extract(castScan(carAndPerson(), SpinningLidar()));
  ASSERT_EQ(scan.measurements.size(), 2u);
  const Measurement *car = withLabel(scan, 0), *person = withLabel(scan, 1);
  ASSERT_TRUE(car && person);
  EXPECT_LT((car->position - Vector2(14, 4)).norm(), 0.5);
  EXPECT_LT((person->position - Vector2(10, -3)).norm(), 0.4);
  EXPECT_EQ(scan.modality, Modality::kLidar);
  EXPECT_TRUE(scan.model && scan.occlusion);
}

// There, no track has a chance of detection: each scan would bear a new one.
TEST(LidarFrontEnd, WhatBeginsBeyondTheRangeOfTheSensorIsNotMeasured) {
  DetectionParams detection;
  detection.range_max = 11;  // the person stands at 10.4 m, the car begins at 12 m
  const SensorFrame frame = castScan(carAndPerson(), SpinningLidar());
  for (const auto& classifier : {std::shared_ptr<const ClusterClassifier>(), alwaysVehicle()}) {
    const MeasurementScan scan = frontEnd({}, detection, classifier).extract(frame);
    ASSERT_EQ(scan.measurements.size(), 1u);
    EXPECT_LT((scan.measurements[0].position - Vector2(10, -3)).norm(), 0.4);
  }
}

TEST(LidarFrontEnd, MeasuresTheOutlineWithinItsNoise) {
  const SolidScene scene = carAndPerson();
  const SensorFrame frame = castScan(scene, SpinningLidar());
  const MeasurementScan scan = frontEnd().extract(frame);
  const Measurement* car = withLabel(scan, 0);
  ASSERT_TRUE(car);
  double left = -kPi, right = kPi;
  for (const Vector2& corner : corners(scene.boxes[0])) {
    left = std::max(left, std::atan2(corner.y(), corner.x()));
    right = std::min(right, std::atan2(corner.y(), corner.x()));
  }
  ASSERT_EQ(car->seen, FootprintModel::kAll);
  EXPECT_NEAR(car->z[FootprintModel::kLeft], left, 2 * std::sqrt(car->R(0, 0)));
  EXPECT_NEAR(car->z[FootprintModel::kRight], right, 2 * std::sqrt(car->R(1, 1)));
  const double nearest = distanceToHull(corners(scene.boxes[0]), Vector2::Zero());
  EXPECT_NEAR(car->z[FootprintModel::kRange], nearest, 2 * std::sqrt(car->R(2, 2)));
  const Eigen::Matrix3d R = car->R;
  EXPECT_EQ(Eigen::LLT<Eigen::Matrix3d>(R).info(), Eigen::Success);
}

TEST(LidarFrontEnd, GivesSizeDirectionBaseAndHeight) {
  const MeasurementScan scan = frontEnd().extract(castScan(carAndPerson(), SpinningLidar()));
  const Measurement *car = withLabel(scan, 0), *person = withLabel(scan, 1);
  ASSERT_TRUE(car && person && car->sides && car->base_z && car->height && person->height);
  EXPECT_NEAR(wrapAxis(car->sides->yaw - 0.5), 0, 2 * car->sides->yaw_sigma);
  EXPECT_NEAR(car->sides->length, 4.4, 0.3);
  EXPECT_NEAR(car->base_z->mean, 0, 0.1);
  EXPECT_NEAR(car->height->mean, 1.5, 2 * std::sqrt(car->height->variance));
  EXPECT_NEAR(person->height->mean, 1.75, 2 * std::sqrt(person->height->variance));
}

TEST(LidarFrontEnd, MovesWithTheVehicle) {
  SensorFrame frame = castScan(carAndPerson(), SpinningLidar());
  const MeasurementScan here = frontEnd().extract(frame);
  frame.ego.T_world_ego = makePose(120, -40, 5, radians(100));
  const MeasurementScan there = frontEnd().extract(frame);
  ASSERT_EQ(here.measurements.size(), there.measurements.size());
  for (std::size_t i = 0; i < here.measurements.size(); ++i) {
    const Measurement &a = here.measurements[i], &b = there.measurements[i];
    EXPECT_LT((a.z - b.z).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_LT((a.R - b.R).cwiseAbs().maxCoeff(), 1e-9);
    const Vector3 moved = frame.ego.T_world_ego * Vector3(a.position.x(), a.position.y(), 0);
    EXPECT_LT((moved.head<2>() - b.position).norm(), 1e-6);
    EXPECT_NEAR(b.base_z->mean, a.base_z->mean + 5, 1e-6);
  }
}

TEST(LidarFrontEnd, AnEdgeBehindATallerObjectIsNotSeen) {
  SolidScene scene;
  scene.boxes = {{{20, 0}, kPi / 2, 4.4, 1.8, 0.25, 1.5},  // across the line of sight
                 {{10, 1.5}, 0, 1.5, 1.5, 0.25, 2.5}};     // hides its left end
  const MeasurementScan scan = frontEnd().extract(castScan(scene, SpinningLidar()));
  const Measurement* car = nullptr;
  for (const Measurement& m : scan.measurements)
    if (m.position.x() > 15) car = &m;
  ASSERT_TRUE(car && car->sides);
  EXPECT_FALSE(car->seen >> FootprintModel::kLeft & 1);
  EXPECT_TRUE(car->seen >> FootprintModel::kRight & 1);
  EXPECT_FALSE(car->sides->length_complete);
  // And the horizon says so: what stands behind the box is hidden, what stands beside it is not.
  const double bearing = std::atan2(1.5, 10);
  EXPECT_LT(scan.occlusion->visibility(bearing - 0.03, bearing + 0.03, 25, 1), 0.05);
  EXPECT_GT(scan.occlusion->visibility(-0.5, -0.4, 25, 1), 0.95);
}

TEST(LidarFrontEnd, WhatIsSeenBetweenTwoTallerObjectsHasAPlace) {
  SolidScene scene;
  scene.boxes = {{{20, 0}, kPi / 2, 4.4, 1.8, 0.25, 1.5},
                 {{10, 1.5}, 0, 1.5, 2, 0.25, 2.5},
                 {{10, -1.5}, 0, 1.5, 2, 0.25, 2.5}};  // hide both its ends
  const SensorFrame frame = castScan(scene, SpinningLidar());
  const auto carOf = [](const MeasurementScan& scan) {
    const auto car = std::find_if(scan.measurements.begin(), scan.measurements.end(),
                                  [](const Measurement& m) { return m.position.x() > 15; });
    EXPECT_NE(car, scan.measurements.end());
    return *car;
  };
  const Measurement by_size = carOf(frontEnd().extract(frame));
  EXPECT_EQ(by_size.seen, 1 << FootprintModel::kRange) << "told by size: the range alone";
  const Measurement by_shape =
      carOf(test::shapedFrontEnd({ObjectShape::kVehicle}, alwaysVehicle()).extract(frame));
  ASSERT_EQ(by_shape.seen, FootprintModel::kAll);
  const double edge = std::sqrt(by_shape.R(FootprintModel::kLeft, FootprintModel::kLeft));
  EXPECT_NEAR(edge, 2.5 / 19, 0.03) << "[rad] 2.5 m";
}

TEST(LidarFrontEnd, ByItsShapeACarIsDetectedAsLongAsAQuarterOfItsWidthIsInView) {
  ClassTable classes;
  classes.classes.resize(1);
  DetectionParams params;
  params.fov = radians(90);
  const LidarFrontEnd front_end(
      {}, classes, DetectionModel(params, {ClassDetection{}}, LidarFrontEnd::labels({})),
      alwaysVehicle());
  const auto model = front_end.extract(castScan(carAndPerson(), SpinningLidar())).model;
  const Extent extent{4, 2, 0.1, 0.1};
  const auto detected = [&](double bearing_deg) {
    Kinematics car;
    car.has_yaw = true;
    car.q[Kinematics::kYaw] = radians(bearing_deg + 90);  // seen from its side
    car.q.head<2>() = 10 * Vector2(std::cos(radians(bearing_deg)), std::sin(radians(bearing_deg)));
    return model->detectionProbability(0, car, extent, SensorState{}, 1);
  };
  const double half = degrees(std::atan2(2, 10));  // 11.3 deg to each side of its center
  EXPECT_DOUBLE_EQ(detected(0), 0.9);
  EXPECT_DOUBLE_EQ(detected(45), 0.9) << "half of it";
  EXPECT_NEAR(detected(45 + half * 0.5), 0.9, 1e-9) << "a quarter of it";
  EXPECT_NEAR(detected(45 + half * 0.75), 0.45, 1e-9) << "an eighth";
  EXPECT_DOUBLE_EQ(detected(45 + half + 1), 0);
  EXPECT_DOUBLE_EQ(detected(-45), 0.9);
}

TEST(LidarFrontEnd, ObjectsCloseTogetherAreUnstableOrLeftOut) {
  SolidScene scene;
  scene.boxes = {{{14, 4}, 0, 4.4, 1.8, 0.25, 1.5},
                 {{14, 1.5}, 0, 4.4, 1.8, 0.25, 1.5}};  // .7 m apart
  const SensorFrame frame = castScan(scene, SpinningLidar());
  const MeasurementScan both = frontEnd().extract(frame);
  ASSERT_GE(both.measurements.size(), 2u);
  EXPECT_FALSE(withLabel(both, 0));
  EXPECT_TRUE(withLabel(both, 2));
  LidarParams paper;
  paper.clusters.accept_unstable = false;
  EXPECT_FALSE(withLabel(frontEnd(paper).extract(frame), 0));
}

TEST(LidarFrontEnd, BadPointsChangeNothing) {
  SensorFrame frame = castScan(carAndPerson(), SpinningLidar());
  const MeasurementScan clean = frontEnd().extract(frame);
  auto& cloud = std::get<LidarCloud>(frame.data);
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
        -std::numeric_limits<float>::infinity(), 3e38f})
    cloud.x.push_back(bad), cloud.y.push_back(bad), cloud.z.push_back(1);
  const MeasurementScan dirty = frontEnd().extract(frame);
  EXPECT_EQ(frontEnd().detect(frame).points.dropped, 4u);
  ASSERT_EQ(dirty.measurements.size(), clean.measurements.size());
  for (std::size_t i = 0; i < clean.measurements.size(); ++i)
    EXPECT_EQ(dirty.measurements[i].z, clean.measurements[i].z);
}

TEST(LidarFrontEnd, ReturnsWithoutRangeAreDroppedAndCounted) {
  SensorFrame frame = castScan(carAndPerson(), SpinningLidar());
  const std::size_t measured = frontEnd().extract(frame).measurements.size();
  auto& cloud = std::get<LidarCloud>(frame.data);
  for (int i = 0; i < 5; ++i) cloud.x.push_back(0), cloud.y.push_back(0), cloud.z.push_back(0);
  const MeasurementScan scan = frontEnd().extract(frame);
  EXPECT_EQ(scan.dropped_points, 5u);
  EXPECT_EQ(scan.measurements.size(), measured);
}

TEST(LidarFrontEnd, AScanBeyondTheLimitIsThinnedAndCounted) {
  LidarParams params;
  params.points.max_points = 10000;
  const SensorFrame frame = castScan(carAndPerson(), SpinningLidar());
  const std::size_t size = std::get<LidarCloud>(frame.data).size();
  ASSERT_GT(size, 3 * 10000u);
  const LidarDetections found = frontEnd(params).detect(frame);
  EXPECT_EQ(found.ground.size(), size);
  EXPECT_LE(size - found.points.capped, 10000u + 16u);
  EXPECT_GT(size - found.points.capped, 5000u);
  EXPECT_EQ(frontEnd(params).extract(frame).dropped_points, found.points.capped);
  EXPECT_EQ(found.points.source.back() / 16 % (size / 10000 + 1), 0u);  // whole groups of 16
}

TEST(EgoPoints, FiftyMillionReturnsAreThinnedToTheLimitAndTheRestIsSaid) {
  constexpr std::size_t kReturns = 50000000;
  SensorFrame frame;
  LidarCloud cloud;
  cloud.x.assign(kReturns, 10), cloud.y.assign(kReturns, 5), cloud.z.assign(kReturns, 1);
  frame.data = std::move(cloud);
  const PointParams params;
  const EgoPoints points = usablePoints(frame, params);
  EXPECT_LE(points.size(), static_cast<std::size_t>(params.max_points) + 16);
  EXPECT_GT(points.size(), static_cast<std::size_t>(params.max_points) / 2);
  EXPECT_EQ(points.size() + points.capped, kReturns);
}

TEST(LidarFrontEnd, PhantomsJoinNothingAndHideNothing) {
  SensorFrame frame = castScan(carAndPerson(), SpinningLidar());
  const MeasurementScan clear = frontEnd().extract(frame);
  auto& cloud = std::get<LidarCloud>(frame.data);
  cloud.trust.assign(cloud.size(), 1.0f);
  Rng rng(RngKey{3, 0, 0, 17});
  for (int i = 0; i < 400; ++i) {  // snow about the car and before it
    cloud.x.push_back(static_cast<float>(rng.uniform(5, 18)));
    cloud.y.push_back(static_cast<float>(rng.uniform(0, 8)));
    cloud.z.push_back(static_cast<float>(rng.uniform(-1.2, 0.2)));
    cloud.trust.push_back(0.05f);
  }
  const MeasurementScan snowy = frontEnd().extract(frame);
  ASSERT_EQ(snowy.measurements.size(), clear.measurements.size());
  for (std::size_t i = 0; i < clear.measurements.size(); ++i) {
    EXPECT_EQ(snowy.measurements[i].label, clear.measurements[i].label);
    EXPECT_LT((snowy.measurements[i].z - clear.measurements[i].z).norm(), 0.01);
  }
  EXPECT_GT(snowy.occlusion->visibility(0.1, 0.2, 10, 1), 0.95);
}

TEST(LidarFrontEnd, FramesWithoutPointsGiveNothing) {
  SensorFrame frame;
  frame.data = LidarCloud{};
  EXPECT_TRUE(frontEnd().extract(frame).measurements.empty());
  frame.data = ObjectDetections{};
  EXPECT_TRUE(frontEnd().extract(frame).measurements.empty());
}

TEST(LidarFrontEnd, GroundAndObstaclesAreDisjoint) {
  const SensorFrame frame = castScan(carAndPerson(), SpinningLidar());
  const LidarFrontEnd lidar = frontEnd();
  const LidarDetections found = lidar.detect(frame);
  ASSERT_EQ(found.ground.size(), std::get<LidarCloud>(frame.data).size());
  for (const std::uint32_t i : found.obstacles) ASSERT_EQ(found.ground[found.points.source[i]], 0);
  for (const std::uint32_t i : found.obstacles) {
    ASSERT_GT(found.points.z[i], 0.3);
    ASSERT_LT(found.points.z[i], 3.0);
  }
}

TEST(LidarFrontEnd, ReadsItsSectionsAndReportsBadOnes) {
  const std::string text =
      "[class.car]\nprior = 1\n[sensor.TOP]\nkind = lidar\nlabel.x = "
      "1\n[sensor.TOP.clusters]\nnear_threshold = 2\n";
  Config config = Config::fromText(text);
  const ClassTable classes = readClassTable(config);
  makeLidarFrontEnd(config, "TOP", classes);
  EXPECT_THROW(config.finish(), ConfigError);  // near above far, and an unknown key

  Config good =
      Config::fromText("[class.car]\nprior = 1\n[sensor.TOP.clusters]\naccept_unstable = false\n");
  const ClassTable cars = readClassTable(good);
  const auto lidar = makeLidarFrontEnd(good, "TOP", cars);
  EXPECT_NO_THROW(good.finish());
  EXPECT_EQ(lidar->extract(castScan(carAndPerson(), SpinningLidar())).measurements.size(), 2u);
}

}  // namespace
}  // namespace perception
