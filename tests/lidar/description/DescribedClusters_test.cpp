#include "libperception/lidar/description/DescribedClusters.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/system/Parallel.h"
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
  SolidScene scene;  // pairs of persons: a whole of two parts each, in different places
  for (int k = -15; k <= 15; ++k) {
    const double angle = 0.1 * k, range = 14 + 0.1 * k;
    for (const double side : {-0.36, 0.36})
      scene.cylinders.push_back({{range * std::cos(angle) - side * std::sin(angle),
                                  range * std::sin(angle) + side * std::cos(angle)},
                                 0.25,
                                 0,
                                 1.7 + 0.01 * k});
  }
  ObstacleScan scan(scene);
  const DirectionCells cells(scan.found.points);
  const auto with = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return describedClusters(scan.found, scan.cloud(), cells);
  };
  const auto one = with(1), two = with(2);
  ASSERT_GT(one.size(), 60u);
  ASSERT_EQ(two.size(), one.size());
  for (std::size_t k = 0; k < one.size(); ++k) {
    EXPECT_EQ(two[k].segment.points, one[k].segment.points) << k;
    EXPECT_EQ(two[k].segment.whole, one[k].segment.whole) << k;
    EXPECT_EQ(two[k].descriptor, one[k].descriptor) << k;
  }
}

}  // namespace
}  // namespace perception
