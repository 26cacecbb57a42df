#include "libperception/lidar/classification/CloudedSurfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/lidar/classification/JudgedClusters.h"
#include "tests/support/ClusterScenes.h"

namespace perception {
namespace {

/// What is up to 0.8 m long is a pedestrian, what is longer a phantom, each with `likely` [-] and
/// the rest a thing.
ClusterClassifier personsOrPhantoms() {
  BoostedTrees trees;
  for (std::size_t k = 0; k < kClusterKinds; ++k) {
    const bool person = k == static_cast<std::size_t>(ClusterKind::kPedestrian);
    const bool phantom = k == static_cast<std::size_t>(ClusterKind::kPhantom);
    const float thing = k == static_cast<std::size_t>(ClusterKind::kThing) ? 0.0f : -9.0f;
    const auto root = static_cast<std::int32_t>(trees.nodes.size());
    trees.roots.push_back(root);
    trees.nodes.push_back({static_cast<std::int16_t>(Feature::kLength), 0.8f, root + 1, root + 2});
    trees.nodes.push_back({-1, person ? 2.0f : thing, 0, 0});
    trees.nodes.push_back({-1, phantom ? 2.0f : thing, 0, 0});
  }
  return {trees, std::array<Calibration, kClusterKinds>{},
          std::array<double, kClusterKinds>{0.2, 0.2, 0.2, 0.15, 0.05, 0.2}, EvidenceMemory{},
          Provenance{}};
}

/// A person 8 m ahead, a wall behind, and fog: one beam in ten about the person returns from
/// 0.1 to 0.9 m before 8 m, and is doubted.
SensorFrame personInFog(bool with_person = true) {
  test::SolidScene scene;
  scene.boxes = {{{14, 0}, kPi / 2, 12, 0.3, 0, 4}};
  if (with_person) scene.cylinders = {{{8, 0}, 0.25, 0, 1.75}};
  SensorFrame frame = test::castScan(scene, test::narrowLidar());
  auto& cloud = std::get<LidarCloud>(frame.data);
  cloud.trust.assign(cloud.size(), 1);
  Rng rng(RngKey{1, 0, 0, 7});
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float range = std::hypot(cloud.x[i], cloud.y[i], cloud.z[i]);
    if (range < 7 || std::abs(std::atan2(cloud.y[i], cloud.x[i])) > 0.09f ||
        rng.uniform(0, 1) > 0.1)
      continue;
    const float scale = static_cast<float>(rng.uniform(7.1, 7.9)) / range;
    cloud.x[i] *= scale, cloud.y[i] *= scale, cloud.z[i] *= scale;
    cloud.trust[i] = 0.7f;
  }
  return frame;
}

std::vector<std::uint32_t> nearPerson(const LidarDetections& found) {
  return test::obstaclesWhere(
      found, [](double x, double y) { return x > 6.5 && x < 9 && std::abs(y) < 1.2; });
}

/// The surfaces near the person, by trust or, `walls`, by the beams that pass.
std::vector<DescribedCluster> surfaces(const SensorFrame& frame, bool walls = false) {
  const LidarDetections found = test::plainFrontEnd().detect(frame);
  const DirectionCells cells(found.points);
  const ClusterDescriber describer(found, std::get<LidarCloud>(frame.data), cells);
  const auto near = nearPerson(found);
  EXPECT_GT(near.size(), 50u);
  const auto judge = [](const DescribedCluster&) { return false; };
  return walls ? wallsIn(near, found, cells, describer, judge)
               : surfacesIn(near, found, describer, judge);
}

double lengthOf(const DescribedCluster& c) {
  return static_cast<double>(c.descriptor[static_cast<std::size_t>(Feature::kLength)]);
}

TEST(CloudedSurfaces, APersonIsLeftWithoutTheFogAbout) {
  const auto found = surfaces(personInFog());
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT(lengthOf(found[0]), 0.8);
  EXPECT_GT(found[0].segment.points.size(), 100u);
}

TEST(CloudedSurfaces, FogAloneHasNone) { EXPECT_TRUE(surfaces(personInFog(false)).empty()); }

TEST(CloudedSurfaces, NoBeamPassesAPersonInSpray) {
  const auto walls = surfaces(personInFog(), true);
  ASSERT_EQ(walls.size(), 1u);
  EXPECT_LT(lengthOf(walls[0]), 0.8);
  EXPECT_GT(walls[0].segment.points.size(), 100u);
  EXPECT_TRUE(surfaces(personInFog(false), true).empty()) << "beams pass spray";
}

TEST(CloudedSurfaces, APersonInSprayOfWhichNothingIsDoubtedIsMeasured) {
  SensorFrame frame = personInFog();
  std::get<LidarCloud>(frame.data).trust.clear();
  const LidarDetections found = test::plainFrontEnd().detect(frame);
  const auto personsIn = [&](const CausesHere& causes) {
    const Judgement judgement =
        judgedClusters(found, std::get<LidarCloud>(frame.data), DirectionCells(found.points),
                       personsOrPhantoms(), [=](const Vector2&) { return causes; });
    return std::count_if(judgement.clusters.begin(), judgement.clusters.end(),
                         [](const JudgedCluster& c) { return c.evidence[0] > 1; });
  };
  EXPECT_EQ(personsIn({}), 0) << "in clear air the cluster is what it looks like";
  EXPECT_EQ(personsIn({0, 0, 0, 0, 1}), 1) << "vehicles throw up spray";
  EXPECT_EQ(personsIn({0, 0, 1, 1, 0}), 1) << "a vehicle has just left the place";
}

TEST(CloudedSurfaces, APersonInWhatIsLikelyFogIsMeasured) {
  const SensorFrame frame = personInFog();
  const LidarDetections found = test::plainFrontEnd().detect(frame);
  const auto personsIn = [&](const CausesHere& causes) {
    const Judgement judgement =
        judgedClusters(found, std::get<LidarCloud>(frame.data), DirectionCells(found.points),
                       personsOrPhantoms(), [=](const Vector2&) { return causes; });
    const auto near = nearPerson(found);
    for (const std::uint32_t i : near) {
      if (judgement.phantom[i] == PlacedReturns::kNoCluster) continue;
      EXPECT_GT(judgement.phantom[i], 0.7f) << "the grid hears of the whole, as before";
    }
    return std::count_if(
        judgement.clusters.begin(), judgement.clusters.end(),
        [](const JudgedCluster& c) { return c.evidence[0] > 1 && c.points.size() > 100; });
  };
  EXPECT_EQ(personsIn({0}), 0) << "in clear air the cluster is what it looks like";
  EXPECT_EQ(personsIn({1}), 1);
}

TEST(CloudedSurfaces, AClusterOfDoubtedReturnsIsLikelierAPhantom) {
  test::SolidScene scene;
  scene.cylinders = {{{8, 0}, 0.25, 0, 1.75}};
  const SensorFrame frame = test::castScan(scene, test::narrowLidar());
  LidarDetections found = test::plainFrontEnd().detect(frame);
  const auto phantom = [&](float trust) {
    found.trust.assign(found.obstacles.size(), trust);
    const Judgement judgement = judgedClusters(found, std::get<LidarCloud>(frame.data),
                                               DirectionCells(found.points), personsOrPhantoms());
    EXPECT_EQ(judgement.clusters.size(), 1u);
    EXPECT_LT(*std::max_element(judgement.phantom.begin(), judgement.phantom.end()), 0.1f)
        << "the grid has the trust of each return";
    return judgement.clusters.at(0).phantom;
  };
  EXPECT_LT(phantom(1), 0.1);
  EXPECT_NEAR(1 - phantom(0.6f), 0.6 * (1 - phantom(1)), 1e-6);
}

}  // namespace
}  // namespace perception
