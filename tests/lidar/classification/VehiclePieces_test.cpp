#include "libperception/lidar/classification/VehiclePieces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "libperception/lidar/classification/JudgedClusters.h"
#include "tests/support/ClusterScenes.h"

namespace perception {
namespace {

using test::SolidScene;

/// Sides seen across the line of sight, from one y to another [m].
using Sides = std::vector<std::pair<double, double>>;

double& chanceOf(DescribedCluster& c, ClusterKind kind) {
  return c.probabilities[static_cast<std::size_t>(kind)];
}

/// A tenth of a vehicle for each meter of length, and four tenths; otherwise mixed.
bool judgeByLength(DescribedCluster& c) {
  const double length = c.descriptor[static_cast<std::size_t>(Feature::kLength)];
  c.probabilities = {};
  chanceOf(c, ClusterKind::kVehicle) = std::min(1.0, 0.4 + 0.1 * length);
  chanceOf(c, ClusterKind::kMixed) = 1 - chanceOf(c, ClusterKind::kVehicle);
  return true;
}

/// Clusters of sides 12 m away, `top` [m] high, that stand for themselves.
struct Row {
  explicit Row(const Sides& sides, double top = 1.4) : scan(sceneOf(sides, top)) {
    for (const auto& [from, to] : sides) {
      DescribedCluster c;
      c.segment.points = scan.within(11, 13, from - 0.05, to + 0.05);
      c.descriptor = scan.describe(c.segment.points);
      judgeByLength(c);
      clusters.push_back(c);
    }
    stands.assign(sides.size(), 1);
  }
  static SolidScene sceneOf(const Sides& sides, double top = 1.4) {
    SolidScene scene;
    for (const auto& [from, to] : sides)
      scene.boxes.push_back({{12, (from + to) / 2}, kPi / 2, to - from, 0.3, 0.25, top});
    return scene;
  }
  /// Of the clusters that stand for themselves with their pieces.
  int joined(const ClusterVisitor& judge = judgeByLength) {
    joinPieces(scan.found, ClusterDescriber(scan.found, scan.cloud(), cells), judge, clusters,
               stands);
    return std::accumulate(stands.begin(), stands.end(), 0);
  }

  test::ObstacleScan scan;
  DirectionCells cells{scan.found.points};
  std::vector<DescribedCluster> clusters;
  std::vector<char> stands;
};

TEST(VehiclePieces, WhatMakesAVehicleLikelierIsAPieceOfIt) {
  Row row({{-2, 0.5}, {0.9, 2}});
  const std::size_t returns =
      row.clusters[0].segment.points.size() + row.clusters[1].segment.points.size();
  EXPECT_EQ(row.joined(), 1);
  EXPECT_TRUE(row.stands[0]);
  const std::vector<std::uint32_t>& points = row.clusters[0].segment.points;
  EXPECT_EQ(points.size(), returns);
  EXPECT_TRUE(std::is_sorted(points.begin(), points.end()));
  EXPECT_NEAR(chanceOf(row.clusters[0], ClusterKind::kVehicle), 0.8, 0.02) << "of 4 m";
}

TEST(VehiclePieces, AVehicleMayHaveSeveral) {
  EXPECT_EQ(Row({{-2.6, -1.9}, {-1.5, 0.5}, {0.9, 2}}).joined(), 1);
}

TEST(VehiclePieces, WhatIsApartIsNone) { EXPECT_EQ(Row({{-2, 0.5}, {1.1, 2}}).joined(), 2); }

TEST(VehiclePieces, TwoVehiclesStayTwo) {
  EXPECT_EQ(Row({{-3.2, -0.2}, {0.2, 3.2}}).joined(), 2) << "6.4 m";
}

TEST(VehiclePieces, OneThatIsSureNeedsNone) {
  Row row({{-2, 0.5}, {0.9, 2}});
  chanceOf(row.clusters[0], ClusterKind::kVehicle) = 0.96;
  chanceOf(row.clusters[1], ClusterKind::kVehicle) = 0.4;
  EXPECT_EQ(row.joined(), 2);
}

TEST(VehiclePieces, NeitherPersonsNorSureThingsAreSome) {
  for (const auto kind : {ClusterKind::kPedestrian, ClusterKind::kCyclist, ClusterKind::kThing}) {
    Row row({{-2, 0.5}, {0.9, 2}});
    row.clusters[1].probabilities = {};
    chanceOf(row.clusters[1], kind) = kind == ClusterKind::kThing ? 0.95 : 0.4;
    EXPECT_EQ(row.joined(), 2) << static_cast<int>(kind);
    chanceOf(row.clusters[1], kind) -= 0.15;
    EXPECT_EQ(row.joined(), 1) << static_cast<int>(kind);
  }
}

TEST(VehiclePieces, WhatDoesNotMakeItLikelierIsNone) {
  Row row({{-2, 0.5}, {0.9, 2}});
  chanceOf(row.clusters[0], ClusterKind::kVehicle) = 0.85;
  EXPECT_EQ(row.joined(), 2) << ".8 together";
}

/// A truck of 10 m in two pieces: one may be a vehicle, the other looks like a thing.
Row truck(double top = 2.6, double gap = 0.3, double second = 0.1) {
  Row row({{-5, 0}, {gap, 5}}, top);
  for (const std::size_t i : {0, 1}) row.clusters[i].probabilities = {};
  chanceOf(row.clusters[0], ClusterKind::kVehicle) = 0.75;
  chanceOf(row.clusters[1], ClusterKind::kVehicle) = second;
  chanceOf(row.clusters[1], ClusterKind::kThing) = 1 - second;
  return row;
}

TEST(VehiclePieces, WhatContinuesTheSideOfAHighOneIsAPieceOfATruck) {
  Row row = truck();
  EXPECT_EQ(row.joined(), 1);
  EXPECT_NEAR(row.clusters[0].descriptor[static_cast<std::size_t>(Feature::kLength)], 10, 0.2);
}

TEST(VehiclePieces, ATruckIsAsLikelyOneAsItsLikeliestPiece) {
  const auto whole = [](double vehicle) {
    Row row = truck();
    EXPECT_EQ(row.joined([&](DescribedCluster& c) {
      c.probabilities = {};
      chanceOf(c, ClusterKind::kVehicle) = vehicle, chanceOf(c, ClusterKind::kThing) = 1 - vehicle;
      return true;
    }),
              vehicle < 0.1 ? 2 : 1);
    return chanceOf(row.clusters[0], ClusterKind::kVehicle);
  };
  EXPECT_EQ(whole(0.2), 0.75);
  EXPECT_EQ(whole(0.9), 0.9);
  EXPECT_EQ(whole(0.05), 0.75) << "surely none: the pieces stand for themselves";
}

TEST(VehiclePieces, AHighVanTakesNothingBesideIt) {
  Row row({{-4.5, 0}, {0.3, 2.9}}, 2.2);
  for (const std::size_t i : {0, 1}) row.clusters[i].probabilities = {};
  chanceOf(row.clusters[0], ClusterKind::kVehicle) = 0.75;
  chanceOf(row.clusters[1], ClusterKind::kThing) = 1;
  EXPECT_EQ(row.joined(), 2) << "7.4 m together";
}

TEST(VehiclePieces, CarsInARowAreNoTruck) { EXPECT_EQ(truck(1.6).joined(), 2) << "1.6 m high"; }

TEST(VehiclePieces, WhatBeginsBehindAGapIsNoPieceOfATruck) {
  EXPECT_EQ(truck(2.6, 0.7).joined(), 2);
}

TEST(VehiclePieces, TwoHighVehiclesStayTwo) { EXPECT_EQ(truck(2.6, 0.3, 0.8).joined(), 2); }

TEST(VehiclePieces, ACarBehindAPostIsOneCluster) {
  SolidScene scene = Row::sceneOf({{-2, 2}});
  scene.cylinders = {{{9, 0.4}, 0.16, 0, 3}};
  test::ObstacleScan scan(scene);
  const auto tree = [](float vehicle) {
    return std::array<float, 2>{vehicle, vehicle + 2};  // up to 3 m of length, above
  };
  BoostedTrees trees;
  for (std::size_t k = 0; k < kClusterKinds; ++k) {
    const auto root = static_cast<std::int32_t>(trees.nodes.size());
    const bool vehicle = k == static_cast<std::size_t>(ClusterKind::kVehicle);
    const auto scores = vehicle ? tree(1)
                        : k == static_cast<std::size_t>(ClusterKind::kMixed)
                            ? std::array<float, 2>{0, 0}
                            : std::array<float, 2>{-6, -6};
    trees.roots.push_back(root);
    trees.nodes.push_back({static_cast<std::int16_t>(Feature::kLength), 3.0f, root + 1, root + 2});
    trees.nodes.push_back({-1, scores[0], 0, 0});
    trees.nodes.push_back({-1, scores[1], 0, 0});
  }
  const ClusterClassifier classifier(
      trees, std::array<Calibration, kClusterKinds>{},
      std::array<double, kClusterKinds>{0.2, 0.2, 0.2, 0.15, 0.05, 0.2}, EvidenceMemory{},
      Provenance{});
  const Judgement judgement =
      judgedClusters(scan.found, scan.cloud(), DirectionCells(scan.found.points), classifier);
  const auto of_car =
      std::count_if(judgement.clusters.begin(), judgement.clusters.end(),
                    [&](const JudgedCluster& c) { return scan.found.x[c.points.front()] > 10; });
  EXPECT_EQ(of_car, 1);
}

}  // namespace
}  // namespace perception
