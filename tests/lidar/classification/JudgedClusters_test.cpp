#include "libperception/lidar/classification/JudgedClusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/ClusterScenes.h"

namespace perception {
namespace {

using test::SolidScene;

/// Scores by length [m]: up to 0.8 that of a `person`, to 2 that of a `pair` of them, to 6 that of
/// a vehicle, above that of a thing.
std::shared_ptr<const ClusterClassifier> byLength(float pair = -4, float person = 4,
                                                  float phantom = -20) {
  const auto length = static_cast<std::int16_t>(Feature::kLength);
  BoostedTrees trees;
  const auto add = [&](const std::array<float, 4>& values) {
    const auto root = static_cast<std::int32_t>(trees.nodes.size());
    trees.roots.push_back(root);
    const float bounds[] = {0.8f, 2.0f, 6.0f};
    for (std::int32_t i = 0; i < 3; ++i) {
      trees.nodes.push_back({length, bounds[i], root + 2 * i + 1, root + 2 * i + 2});
      trees.nodes.push_back({-1, values[static_cast<std::size_t>(i)], 0, 0});
    }
    trees.nodes.push_back({-1, values[3], 0, 0});
  };
  add({person, pair, -4, -4});
  add({-4, -4, -4, -4});
  add({-4, -4, 2, -4});
  add({0, 0, 0, 4});
  add({phantom, -20, -20, -20});  // as short as a person
  add({-20, -20, -20, -20});
  EvidenceMemory memory;
  memory.lasting = 0.35;
  return std::make_shared<const ClusterClassifier>(
      trees, std::array<Calibration, kClusterKinds>{},
      std::array<double, kClusterKinds>{0.2, 0.2, 0.2, 0.15, 0.05, 0.2}, memory, Provenance{});
}

/// Scores vehicles alone: up to 3 m of length `shorter`, above `longer`; things 0, others -6.
std::shared_ptr<const ClusterClassifier> vehiclesByLength(float shorter, float longer) {
  BoostedTrees trees;
  const auto add = [&](float low, float high) {
    const auto root = static_cast<std::int32_t>(trees.nodes.size());
    trees.roots.push_back(root);
    trees.nodes.push_back({static_cast<std::int16_t>(Feature::kLength), 3.0f, root + 1, root + 2});
    trees.nodes.push_back({-1, low, 0, 0});
    trees.nodes.push_back({-1, high, 0, 0});
  };
  for (std::size_t k = 0; k < kClusterKinds; ++k) {
    const bool thing = k == static_cast<std::size_t>(ClusterKind::kThing);
    const bool vehicle = k == static_cast<std::size_t>(ClusterKind::kVehicle);
    add(vehicle ? shorter : thing ? 0 : -6, vehicle ? longer : thing ? 0 : -6);
  }
  return std::make_shared<const ClusterClassifier>(
      trees, std::array<Calibration, kClusterKinds>{},
      std::array<double, kClusterKinds>{0.2, 0.2, 0.2, 0.15, 0.05, 0.2}, EvidenceMemory{},
      Provenance{});
}

/// A van seen from the side, a person, and a wall of 8 m.
SolidScene parkedStreet() {
  SolidScene scene;
  scene.boxes = {{{12.9, 0}, kPi / 2, 4.4, 1.8, 0.25, 2}, {{25, 2}, kPi / 2, 8, 0.3, 0, 4}};
  scene.cylinders = {{{10, -4}, 0.25, 0, 1.75}};
  return scene;
}

/// Two persons 0.22 m apart at 15 m, to the left.
SolidScene couple() {
  SolidScene scene;
  scene.cylinders = {{{15, 1.64}, 0.25, 0, 1.75}, {{15, 2.36}, 0.25, 0, 1.75}};
  return scene;
}

Judgement judge(const SensorFrame& frame, const LidarDetections& found,
                const ClusterClassifier& classifier, const CausesAt& causes_at = {}) {
  return judgedClusters(found, std::get<LidarCloud>(frame.data), DirectionCells(found.points),
                        classifier, causes_at);
}

struct Judged {
  SensorFrame frame;
  LidarDetections found;
  std::vector<JudgedCluster> clusters;

  explicit Judged(const SolidScene& scene,
                  const std::shared_ptr<const ClusterClassifier>& classifier = byLength())
      : frame(test::castScan(scene, test::narrowLidar())),
        found(test::plainFrontEnd().detect(frame)),
        clusters(judge(frame, found, *classifier).clusters) {}

  Vector2 middleOf(const JudgedCluster& c) const {
    Vector2 sum = Vector2::Zero();
    for (const std::uint32_t i : c.points)
      sum += Vector2(static_cast<double>(found.x[i]), static_cast<double>(found.y[i]));
    return sum / static_cast<double>(c.points.size());
  }
};

double of(const JudgedCluster& c, ClusterKind kind) {
  return c.evidence[static_cast<std::size_t>(kind)];
}

TEST(JudgedClusters, ThingsAreLeftOut) {
  const Judged judged(parkedStreet());
  ASSERT_EQ(judged.clusters.size(), 2u) << "not the wall";
  const bool person_first = judged.clusters[0].points.size() < judged.clusters[1].points.size();
  const JudgedCluster &person = judged.clusters[person_first ? 0 : 1],
                      &car = judged.clusters[person_first ? 1 : 0];
  EXPECT_LT((judged.middleOf(person) - Vector2(10, -4)).norm(), 0.5);
  EXPECT_LT((judged.middleOf(car) - Vector2(12, 0)).norm(), 0.5);
  EXPECT_NEAR(of(person, ClusterKind::kPedestrian), 4, 1e-6);
  EXPECT_NEAR(of(person, ClusterKind::kVehicle), -4, 1e-6);
  // 4.4 m long: the scores of people, -4 each, are a thing's.
  EXPECT_NEAR(of(car, ClusterKind::kVehicle), 2 - std::log(1 + 2 * std::exp(-4.0)), 1e-6);
  EXPECT_EQ(of(car, ClusterKind::kThing), 0);
  EXPECT_TRUE(person.alone);
  EXPECT_TRUE(std::is_sorted(car.points.begin(), car.points.end()));
}

TEST(JudgedClusters, WhatIsWiderThanAnyRoadUserIsNone) {
  const auto vehicles = [](double width) {
    SolidScene scene;
    scene.boxes = {{{14, 3}, 0.7, 5, width, 0.25, 2}};  // two sides seen; a vehicle by its length
    return Judged(scene, byLength()).clusters.size();
  };
  EXPECT_EQ(vehicles(2.5), 1u);
  EXPECT_EQ(vehicles(4.5), 0u) << "a house";
}

TEST(JudgedClusters, WhatIsLongAndLowIsNoVehicle) {
  const auto vehicles = [](double length, double height) {
    SolidScene scene;
    scene.boxes = {{{13, 0}, kPi / 2, length, 2, 0.25, height}};
    scene.cylinders = {{{30, -14}, 0.3, 0, 6}};  // shows how high the view reaches
    const Judged judged(scene, vehiclesByLength(4, 4));
    return std::count_if(judged.clusters.begin(), judged.clusters.end(),
                         [&](const auto& c) { return std::abs(judged.middleOf(c).y()) < 5; });
  };
  EXPECT_EQ(vehicles(9, 2.4), 1) << "a bus, as high as the view";
  EXPECT_EQ(vehicles(9, 1.6), 0) << "a hedge";
  EXPECT_EQ(vehicles(6, 1.1), 0) << "a low wall";
  EXPECT_EQ(vehicles(5, 1.1), 1) << "a low car";
  EXPECT_EQ(vehicles(6, 1.6), 1) << "a van";
  EXPECT_EQ(vehicles(4.5, 1.6), 1) << "a car";
}

TEST(JudgedClusters, PartsOfWhatHasRoomForOneVehicleAreNoVehicles) {
  const auto vehicles = [](double half, float whole) {  // [m]: of the two parts of a side
    SolidScene scene;
    for (const double sign : {-1, 1})
      scene.boxes.push_back({{12, sign * (half / 2 + 0.11)}, kPi / 2, half, 0.3, 0.25, 1.4});
    return Judged(scene, vehiclesByLength(1.5f, whole)).clusters.size();
  };
  EXPECT_EQ(vehicles(2.1, 0.5f), 1u) << "a car by .62, each half by .82";
  EXPECT_EQ(vehicles(2.1, -0.3f), 2u) << "by .43";
  EXPECT_EQ(vehicles(2.95, 0.5f), 2u) << "there is room for two";
}

TEST(JudgedClusters, WhatIsSurelyAPhantomIsLeftOutAndSaidOfItsReturns) {
  const SolidScene scene = parkedStreet();
  const Judged doubted(scene, byLength(-4, 4, 3)), judged(scene, byLength(-4, 4, 9));
  EXPECT_EQ(doubted.clusters.size(), 2u) << "a phantom by .27, a person by .72";
  ASSERT_EQ(judged.clusters.size(), 1u) << "the car";
  const Judgement judgement = judge(judged.frame, judged.found, *byLength(-4, 4, 9));
  ASSERT_EQ(judgement.phantom.size(), judged.found.obstacles.size());
  for (std::size_t i = 0; i < judgement.phantom.size(); ++i) {
    if (judgement.phantom[i] == PlacedReturns::kNoCluster) continue;
    EXPECT_EQ(judgement.phantom[i] > 0.9f, judged.found.y[i] < -3) << "the person alone";
  }
}

TEST(JudgedClusters, APhantomIsSurerWhereSomethingMakesPhantoms) {
  const Judged judged(parkedStreet(), byLength(-4, 4, 3));
  ASSERT_EQ(judged.clusters.size(), 2u) << "the person, a phantom by .27, stands";
  const auto in = [&](const CausesHere& causes) {
    return judge(judged.frame, judged.found, *byLength(-4, 4, 3),
                 [=](const Vector2& place) { return place.y() < -3 ? causes : CausesHere{}; });
  };
  const auto highest = [](const Judgement& j) {
    return *std::max_element(j.phantom.begin(), j.phantom.end());
  };
  const float clear = highest(in({})), air = highest(in({1})), wake = highest(in({0, 0, 0.9}));
  EXPECT_TRUE(clear <= air && clear < wake);
  EXPECT_EQ(in({0.2, 0, 0, 0, 0.7}).clusters.at(0).cause, 0.7) << "in spray";
}

TEST(JudgedClusters, PhantomsAreAccountedForAndWhatIsKeptInDoubtIsSuspicious) {
  const SolidScene scene = parkedStreet();
  const auto verdictsOf = [&](float phantom, float trust) {
    Judged judged(scene);
    judged.found.trust.assign(judged.found.obstacles.size(), trust);
    return judge(judged.frame, judged.found, *byLength(-4, 4, phantom)).verdicts;
  };
  const ClusterVerdicts none = verdictsOf(-20, 1);
  EXPECT_EQ(none.clusters, 3u) << "van, person and wall";
  EXPECT_EQ(none.suspicious, 0u);
  EXPECT_TRUE(none.phantoms.empty());
  const ClusterVerdicts kept = verdictsOf(5, 1);
  EXPECT_EQ(kept.suspicious, 1u) << "a person by .2";
  EXPECT_TRUE(kept.phantoms.empty());
  const ClusterVerdicts trusted = verdictsOf(9, 1), doubted = verdictsOf(9, 0.4f);
  ASSERT_EQ(trusted.phantoms.size(), 1u);
  EXPECT_EQ(trusted.suspicious, 0u);
  EXPECT_GT(trusted.phantoms[0].probability, 0.9);
  EXPECT_GT(trusted.phantoms[0].returns, 10u);
  EXPECT_TRUE(trusted.phantoms[0].doubted.empty());
  ASSERT_EQ(doubted.phantoms.size(), 1u);
  EXPECT_EQ(doubted.phantoms[0].doubted.size(), doubted.phantoms[0].returns);
  const SensorFrame frame = test::castScan(scene, test::narrowLidar());
  for (const std::uint32_t i : doubted.phantoms[0].doubted)
    EXPECT_LT(std::get<LidarCloud>(frame.data).y[i], -3) << "indices in the cloud, of the person";
}

TEST(JudgedClusters, PartsReplaceAWholeThatIsLessLikely) {
  const Judged judged(couple());
  ASSERT_EQ(judged.clusters.size(), 2u);
  double sum = 0;
  for (const JudgedCluster& c : judged.clusters) {
    EXPECT_NEAR(std::abs(judged.middleOf(c).y() - 2), 0.36, 0.1);
    sum += judged.middleOf(c).y() - 2;
    EXPECT_NEAR(of(c, ClusterKind::kPedestrian), 4, 1e-6);
    EXPECT_FALSE(c.alone);
  }
  EXPECT_NEAR(sum, 0, 0.1) << "one to each side";
}

TEST(JudgedClusters, AWholeThatIsLikelierStands) {
  const Judged judged(couple(), byLength(9));
  ASSERT_EQ(judged.clusters.size(), 1u);
  EXPECT_NEAR(judged.middleOf(judged.clusters[0]).y(), 2, 0.1);
  EXPECT_TRUE(judged.clusters[0].alone);
}

TEST(JudgedClusters, ASureWholeIsNotLookedInto) {
  // 0.77 and 0.55 of a pedestrian; each part has 0.98.
  EXPECT_EQ(Judged(couple(), byLength(1.3f)).clusters.size(), 1u);
  EXPECT_EQ(Judged(couple(), byLength(0.3f)).clusters.size(), 2u);
}

/// The low side of a car with something above it, and the same beside it.
SolidScene carWithASeat() {
  SolidScene scene;
  scene.boxes = {{{12.05, 0}, kPi / 2, 4.4, 0.1, 0.25, 0.75}};
  scene.cylinders = {{{12.3, 0}, 0.25, 1.7, 2.3}, {{12.3, 4}, 0.25, 1.7, 2.3}};
  return scene;
}

TEST(JudgedClusters, WhatLiesInALikelyVehicleIsAFragmentOfIt) {
  const Judged judged(carWithASeat(), byLength(-4, 0.5f));
  ASSERT_EQ(judged.clusters.size(), 2u);
  for (const JudgedCluster& c : judged.clusters) {
    const Vector2 middle = judged.middleOf(c);
    const bool car = c.points.size() > 60;
    EXPECT_NEAR(middle.y(), car ? 0 : 4, 0.2) << "not the one above it";
  }
}

TEST(JudgedClusters, APersonInTheFootprintOfAVehicleStands) {
  EXPECT_EQ(Judged(carWithASeat(), byLength(-4, 4)).clusters.size(), 3u);
}

TEST(JudgedClusters, NoReturnsHaveNone) {
  LidarDetections nothing(EgoPoints{}, {}, GroundSurface(GroundPlane{}, EgoPoints{}, {}, nullptr));
  const DirectionCells cells(nothing.points);
  EXPECT_TRUE(judgedClusters(nothing, LidarCloud{}, cells, *byLength()).clusters.empty());
}

// The front end ---------------------------------------------------------------------------------

using Shapes = std::vector<ObjectShape>;

const Measurement* nearest(const MeasurementScan& scan, const Vector2& place) {
  const auto far = [&](const Measurement& m) { return (m.position - place).norm(); };
  const auto best = std::min_element(scan.measurements.begin(), scan.measurements.end(),
                                     [&](auto& a, auto& b) { return far(a) < far(b); });
  return best == scan.measurements.end() ? nullptr : &*best;
}

TEST(JudgedClusters, MeasurementsTellClassesByTheirShape) {
  const LidarFrontEnd lidar =
      test::shapedFrontEnd({ObjectShape::kVehicle, ObjectShape::kThing, ObjectShape::kPedestrian,
                            ObjectShape::kCyclist, ObjectShape::kVehicle},
                           byLength());
  SensorFrame frame = test::castScan(parkedStreet(), test::narrowLidar());
  frame.ego.T_world_ego = makePose(100, -50, 0, 2);
  const MeasurementScan scan = lidar.extract(frame);
  ASSERT_EQ(scan.measurements.size(), 2u);
  const Vector2 place = (frame.ego.T_world_ego * Vector3(10, -4, 0)).head<2>();
  const Measurement* person = nearest(scan, place);
  ASSERT_EQ(person->log_class.size(), 5u);
  const double expected[] = {-4, 0, 4, -4, -4};
  for (std::size_t j = 0; j < 5; ++j) EXPECT_NEAR(person->log_class[j], expected[j], 1e-6) << j;
  EXPECT_EQ(person->log_clutter, 0) << "clutter looks as things do";
  ASSERT_TRUE(person->view);
  const Vector2 sight = Vector2(100, -50) - place;
  EXPECT_NEAR(person->view->bearing, std::atan2(sight.y(), sight.x()), 0.02);
  EXPECT_NEAR(person->view->log_range, std::log(sight.norm()), 0.05);
  ASSERT_NE(scan.model->evidenceMemory(), nullptr);
  EXPECT_EQ(scan.model->evidenceMemory()->lasting, 0.35);
}

TEST(JudgedClusters, WithAClassifierNoneIsBySpacingsOrPeaks) {
  const LidarFrontEnd lidar = test::shapedFrontEnd({ObjectShape::kThing}, byLength());
  const LidarDetections found = lidar.detect(test::castScan(parkedStreet(), test::narrowLidar()));
  EXPECT_EQ(found.judged.size(), 2u);
  EXPECT_TRUE(found.clusters.empty());
  EXPECT_TRUE(found.persons.empty());
}

TEST(JudgedClusters, WithoutAClassifierLabelsAreBySize) {
  const SensorFrame frame = test::castScan(parkedStreet(), test::narrowLidar());
  const LidarFrontEnd lidar = test::plainFrontEnd();
  EXPECT_TRUE(lidar.detect(frame).judged.empty());
  EXPECT_FALSE(lidar.extract(frame).verdicts);
  const MeasurementScan scan = lidar.extract(frame);
  ASSERT_EQ(scan.measurements.size(), 3u) << "the wall as well";
  for (const Measurement& m : scan.measurements) {
    EXPECT_TRUE(m.log_class.empty());
    EXPECT_FALSE(m.view);
  }
  EXPECT_EQ(nearest(scan, {10, -4})->label, 1);
  EXPECT_EQ(nearest(scan, {12, 0})->label, 0);
  EXPECT_EQ(scan.model->evidenceMemory(), nullptr);
}

TEST(JudgedClusters, HaveOutlinesAsOtherClusters) {
  const SensorFrame frame = test::castScan(parkedStreet(), test::narrowLidar());
  const MeasurementScan judged =
      test::shapedFrontEnd({ObjectShape::kThing}, byLength()).extract(frame);
  const MeasurementScan plain = test::plainFrontEnd().extract(frame);
  const Measurement *car = nearest(judged, {12, 0}), *same = nearest(plain, {12, 0});
  ASSERT_TRUE(car && same);
  EXPECT_EQ(car->label, same->label);
  EXPECT_EQ(car->seen, same->seen);
  EXPECT_LT((car->z - same->z).norm(), 0.01);
  EXPECT_EQ(car->R, same->R);
  EXPECT_EQ(nearest(judged, {10, -4})->label, 1);
}

TEST(JudgedClusters, ShapesAreKindsOfTheSameNumber) {
  EXPECT_EQ(kShapes, kObjectShapes);
  for (std::size_t k = 0; k < kShapes; ++k) {
    Config config = Config::fromText(
        "[class.x]\nprior = 1\nshape = " + std::string(kClusterKindNames[k]) + "\n");
    EXPECT_EQ(static_cast<std::size_t>(readClassTable(config)[0].shape), k);
    EXPECT_NO_THROW(config.finish());
  }
}

}  // namespace
}  // namespace perception
