#include "libperception/lidar/classification/ViewEnd.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/lidar/classification/JudgedClusters.h"
#include "tests/support/ClusterScenes.h"

namespace perception {
namespace {

using test::SolidScene;
using test::SpinningLidar;

/// Ahead at a distance [m] a post of that height [m]; houses behind it show how high the view is.
SolidScene postOf(double distance, double height, bool houses = true) {
  SolidScene scene;
  scene.cylinders = {{{distance, 0}, 0.1, 0, height}};
  if (houses) scene.boxes = {{{50, 0}, kPi / 2, 50, 1, 0, 6}};
  return scene;
}

struct Post {
  explicit Post(const SolidScene& scene, const SpinningLidar& lidar = test::narrowLidar())
      : scan(scene, lidar) {}

  double evidence() const { return end.evidence(scan.within(2, 45, -1, 1)); }

  test::ObstacleScan scan;
  DirectionCells cells{scan.found.points};
  ViewEnd end{scan.found, cells};
};

TEST(ViewEnd, APostThatGoesOnAboveTheViewIsHardlyAPerson) {
  EXPECT_LT(Post(postOf(8, 3)).evidence(), -3) << "cut at 2 m";
  EXPECT_NEAR(Post(postOf(5, 3)).evidence(), -2.9, 0.2) << "at 1.9 m";
}

TEST(ViewEnd, WhatTheHighestBeamsPassIsAsHighAsItIsSeen) {
  for (const double distance : {6, 10, 20})
    EXPECT_EQ(Post(postOf(distance, 1.75)).evidence(), 0) << distance;
}

TEST(ViewEnd, BeamsFarApartCutAsWell) {
  SpinningLidar lidar = test::narrowLidar();
  lidar.beams = 16;  // 1.3 deg apart
  lidar.lowest = radians(-18.5), lidar.highest = radians(1);
  EXPECT_LT(Post(postOf(9, 3), lidar).evidence(), -2.5);
  EXPECT_EQ(Post(postOf(9, 1.6), lidar).evidence(), 0);
}

TEST(ViewEnd, PeopleAreCutByALowView) {
  SpinningLidar lidar = test::narrowLidar();
  lidar.T_ego_sensor = makePose(0, 0, 1.1, 0);
  EXPECT_EQ(Post(postOf(5, 1.75), lidar).evidence(), 0) << "cut at 1.3 m, as all people are";
}

TEST(ViewEnd, InTheOpenNothingTellsWhereTheViewEnds) {
  const Post post(postOf(8, 3, false));
  EXPECT_FALSE(post.end.isKnown());
  EXPECT_EQ(post.evidence(), 0);
  EXPECT_TRUE(Post(postOf(8, 3)).end.isKnown());
}

TEST(ViewEnd, AViewThatReachesFarUpCutsNothing) {
  SpinningLidar lidar = test::narrowLidar();
  lidar.highest = radians(15);
  EXPECT_EQ(Post(postOf(8, 3), lidar).evidence(), 0);
}

/// Every cluster is a person by .8 and a thing by .2.
ClusterClassifier personsEverywhere() {
  BoostedTrees trees;
  for (std::size_t k = 0; k < kClusterKinds; ++k) {
    trees.roots.push_back(static_cast<std::int32_t>(trees.nodes.size()));
    const bool person = k == static_cast<std::size_t>(ClusterKind::kPedestrian);
    const bool thing = k == static_cast<std::size_t>(ClusterKind::kThing);
    trees.nodes.push_back({-1, person ? std::log(4.0f) : thing ? 0.0f : -20.0f, 0, 0});
  }
  return ClusterClassifier(trees, {}, {0.2, 0.2, 0.2, 0.15, 0.05, 0.2}, EvidenceMemory{},
                           Provenance{});
}

TEST(ViewEnd, SaysWhatAClusterIs) {
  const auto personAt = [](double distance, double height) {
    Post post(postOf(distance, height));
    for (const JudgedCluster& c :
         judgedClusters(post.scan.found, post.scan.cloud(), post.cells, personsEverywhere())
             .clusters)
      if (c.points.size() < 400 && post.scan.found.x[c.points[0]] < 45)
        return c.evidence[static_cast<std::size_t>(ClusterKind::kPedestrian)];
    return -10.0;
  };
  const double whole = personAt(8, 1.75), cut = personAt(8, 3);
  EXPECT_GT(whole, 1);
  EXPECT_NEAR(cut - whole, Post(postOf(8, 3)).evidence(), 1e-3);
}

TEST(ViewEnd, LeavesTheChanceOfAPhantomToTheGrid) {
  Post post(postOf(8, 3));
  DescribedCluster cluster;
  cluster.segment.points = post.scan.within(2, 45, -1, 1);
  cluster.descriptor = post.scan.describe(cluster.segment.points);
  cluster.probabilities = {0.6, 0, 0, 0.2, 0.1, 0.1};
  post.end.weigh(cluster);
  EXPECT_LT(cluster.probabilities[0], 0.1) << "a person";
  EXPECT_GT(cluster.probabilities[3], 0.5) << "a thing";
  EXPECT_DOUBLE_EQ(cluster.probabilities[4], 0.1) << "a phantom";
  double sum = 0;
  for (const double p : cluster.probabilities) sum += p;
  EXPECT_NEAR(sum, 1, 1e-12);
}

}  // namespace
}  // namespace perception
