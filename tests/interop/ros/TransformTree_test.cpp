#include "libperception/interop/ros/TransformTree.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

/// A vehicle at 1 m/s along x in "odom", which lies 100 m before "map"; a lidar on it.
TransformTree treeOfADrive(int seconds) {
  TransformTree tree;
  tree.add("base", "lidar", Stamp{}, makePose(0, 0, 2, 0), true);
  for (int t = 0; t <= seconds; ++t) {
    tree.add("odom", "base", Stamp::fromSeconds(100 + t), makePose(t, 0, 0, 0), false);
    tree.keep("base", Stamp::fromSeconds(100 + t - 10), Stamp::fromSeconds(100 + t + 1));
  }
  tree.add("map", "odom", Stamp::fromSeconds(105), makePose(100, 0, 0, 0), false);
  tree.settle();
  return tree;
}

TEST(TransformTree, TheNearestStepThatMovesIsFoundFromEveryFrame) {
  const TransformTree tree = treeOfADrive(20);
  EXPECT_EQ(tree.moverOf("lidar"), "base");
  EXPECT_EQ(tree.moverOf("odom"), "odom");
  EXPECT_EQ(tree.moverOf("map"), "");
  EXPECT_EQ(tree.movesIn("lidar"), "map");
}

TEST(TransformTree, TheVehicleTravelsInTheFramesAboveTheStepThatMoves) {
  const TransformTree tree = treeOfADrive(20);
  EXPECT_TRUE(tree.travelsIn("odom", "base"));
  EXPECT_TRUE(tree.travelsIn("map", "lidar"));
  for (const char* frame : {"base", "lidar", "camera"})
    EXPECT_FALSE(tree.travelsIn(frame, "base")) << frame;
  EXPECT_FALSE(tree.travelsIn("map", "map"));
  EXPECT_EQ(tree.rootOf("lidar"), "map");
  EXPECT_EQ(tree.rootOf("camera"), "camera");
}

TEST(TransformTree, AChainIsKnownUntilTheFirstOfItsStepsEnds) {
  const TransformTree tree = treeOfADrive(20);
  EXPECT_EQ(tree.knownUntil("lidar"), Stamp::fromSeconds(105));
  EXPECT_GT(tree.knownUntil("map"), Stamp::fromSeconds(1e9)) << "nothing above it moves";
}

TEST(TransformTree, OldPosesAreForgottenAndThoseOfTheLastSecondsAreThere) {
  const TransformTree tree = treeOfADrive(100);
  EXPECT_FALSE(tree.at("odom", "base", Stamp::fromSeconds(110)));
  const auto T = tree.at("odom", "lidar", Stamp::fromSeconds(195.5));
  ASSERT_TRUE(T);
  EXPECT_NEAR(T->translation().x(), 95.5, 1e-9);
  EXPECT_NEAR(T->translation().z(), 2, 1e-9);
}

TEST(TransformTree, OnePoseStaysWhateverIsForgotten) {
  TransformTree tree;
  tree.add("odom", "base", Stamp::fromSeconds(1), makePose(7, 0, 0, 0), false);
  tree.keep("base", Stamp::fromSeconds(50), Stamp::fromSeconds(60));
  ASSERT_TRUE(tree.at("odom", "base", Stamp::fromSeconds(1)));
}

}  // namespace
}  // namespace perception
