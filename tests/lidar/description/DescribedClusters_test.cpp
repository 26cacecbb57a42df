#include "libperception/lidar/description/DescribedClusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/system/Parallel.h"
#include "libperception/lidar/classification/JudgedClusters.h"
#include "tests/support/ClusterScenes.h"

namespace perception {
namespace {

using test::ObstacleScan;
using test::SolidScene;

TEST(DescribedClusters, LeavesOutWhatIsTooLowOrTooSmall) {
  SolidScene scene;
  scene.boxes = {{{10, 3}, 0, 1, 1, 0, 0.45}};                             // a low block
  scene.cylinders = {{{10, -3}, 0.25, 0, 1.75}, {{60, 0}, 0.1, 0, 1.75}};  // the last: few returns
  ObstacleScan scan(scene);
  EXPECT_GE(scan.within(9, 11, 2, 4).size(), 8u);
  const auto clusters =
      describedClusters(scan.found, scan.cloud(), DirectionCells(scan.found.points));
  ASSERT_EQ(clusters.size(), 1u);
  EXPECT_EQ(clusters[0].segment.points, scan.within(9, 11, -4, -2));
  EXPECT_EQ(clusters[0].descriptor, scan.describe(9, 11, -4, -2));
}

TEST(DescribedClusters, PartsReferToTheirWhole) {
  SolidScene scene;
  scene.boxes = {{{10, 4}, 0, 1, 1, 0, 0.45}};  // left out: the numbers of the others change
  scene.cylinders = {{{15, -2.36}, 0.25, 0, 1.75}, {{15, -1.64}, 0.25, 0, 1.75}};
  ObstacleScan scan(scene);
  const auto clusters =
      describedClusters(scan.found, scan.cloud(), DirectionCells(scan.found.points));
  ASSERT_EQ(clusters.size(), 3u);
  EXPECT_EQ(clusters[0].segment.whole, -1);
  EXPECT_EQ(clusters[1].segment.whole, 0);
  EXPECT_EQ(clusters[2].segment.whole, 0);
}

TEST(DescribedClusters, AreTheSameWhateverTheNumberOfThreads) {
  SolidScene scene;  // posts, and two persons who are a whole of two parts
  scene.cylinders = {
      {{15, -2.36}, 0.25, 0, 1.75}, {{15, -1.64}, 0.25, 0, 1.75}, {{15, -5}, 0.1, 0, 2}};
  for (int k = 0; k < 25; ++k) {
    const double angle = 0.023 * k - 0.07, range = 10 + 2 * (k % 3);
    scene.cylinders.push_back(
        {{range * std::cos(angle), range * std::sin(angle)}, 0.1, 0, 1.7 + 0.01 * k});
  }
  ObstacleScan scan(scene);
  const DirectionCells cells(scan.found.points);
  const auto with = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return describedClusters(scan.found, scan.cloud(), cells);
  };
  const auto one = with(1), two = with(2);
  ASSERT_GE(one.size(), 27u);
  EXPECT_TRUE(
      std::any_of(one.begin(), one.end(), [](const auto& c) { return c.segment.whole > 0; }));
  ASSERT_EQ(two.size(), one.size());
  for (std::size_t k = 0; k < one.size(); ++k) {
    EXPECT_EQ(two[k].segment.points, one[k].segment.points) << k;
    EXPECT_EQ(two[k].segment.whole, one[k].segment.whole) << k;
    EXPECT_EQ(two[k].descriptor, one[k].descriptor) << k;
  }
}

/// A van 12 m away, a person at 10 m and a wall at 25 m.
struct Street {
  SensorFrame frame;
  LidarDetections found;
  DirectionCells cells;

  Street()
      : frame(test::castScan(scene(), test::narrowLidar())),
        found(test::plainFrontEnd().detect(frame)),
        cells(found.points) {}
  static test::SolidScene scene() {
    test::SolidScene street;
    street.boxes = {{{12.9, 0}, kPi / 2, 4.4, 1.8, 0.25, 2}, {{25, 2}, kPi / 2, 8, 0.3, 0, 4}};
    street.cylinders = {{{10, -4}, 0.25, 0, 1.75}};
    return street;
  }
  const LidarCloud& cloud() const { return std::get<LidarCloud>(frame.data); }
  bool isOfWall(std::uint32_t obstacle) const { return found.x[obstacle] > 20; }
};

TEST(DescribedClusters, WholesBeyondReachAreNotDescribed) {
  const Street street;
  const auto all = describedClusters(street.found, street.cloud(), street.cells),
             near = describedClusters(street.found, street.cloud(), street.cells, {}, 18);
  std::size_t beyond = 0;
  for (const DescribedCluster& cluster : near) {
    const bool wall = street.isOfWall(cluster.segment.points.front());
    EXPECT_EQ(cluster.described, !wall || cluster.segment.whole >= 0);
    if (!cluster.described) ++beyond;
    EXPECT_EQ(cluster.descriptor == Descriptor{}, !cluster.described);
  }
  EXPECT_GE(beyond, 1u);
  EXPECT_TRUE(std::all_of(all.begin(), all.end(), [](const auto& c) { return c.described; }));
}

TEST(DescribedClusters, BeyondReachTheyAreThings) {
  const Street street;
  const auto judged = [&](double reach) {
    return judgedClusters(street.found, street.cloud(), street.cells, test::vehiclesAlone(), {},
                          reach);
  };
  const Judgement far = judged(60), near = judged(18);
  EXPECT_EQ(far.clusters.size(), 3u);
  EXPECT_EQ(near.clusters.size(), 2u);
  EXPECT_EQ(near.verdicts.clusters, far.verdicts.clusters);
  for (std::uint32_t i = 0; i < street.found.obstacles.size(); ++i) {
    if (!street.isOfWall(i)) continue;
    EXPECT_EQ(near.phantom[i], 0) << "it stays an obstacle";
  }
}

}  // namespace
}  // namespace perception
