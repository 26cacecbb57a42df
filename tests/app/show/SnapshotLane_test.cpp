#include <gtest/gtest.h>

#include "libperception/pictures/SnapshotSensors.h"
#include "tests/app/DemoLog.h"

namespace perception {
namespace {

using namespace test;

/// A run of the demo log's first two seconds whose last scene may say how far the lane is free.
TrackedRun runThatSays(std::optional<double> free) {
  TrackedRun run;
  for (int k = 0; k <= 20; ++k) {
    run.scenes.emplace_back();
    run.scenes.back().stamp = run.scenes.back().ego.stamp =
        Stamp::fromSeconds(kDemoFirstStamp) + 0.1 * k;
  }
  if (free) run.scenes.back().path.emplace();
  if (free) run.scenes.back().path->distance = run.scenes.back().path->seen = *free;
  return run;
}

double shownFreeLane(const TrackedRun& run) {
  SnapshotSensors sensors(kDemoLog, run, {});
  sensors.advanceTo(run.scenes.back().stamp);
  SceneView view;
  view.scene = run.scenes.back();
  sensors.fill(view);
  EXPECT_TRUE(view.corridor);
  return view.free.known();
}

TEST(SnapshotLane, IsFreeForAsFarAsTheRunSays) {
  EXPECT_EQ(shownFreeLane(runThatSays(7.25)), 7.25);
}

TEST(SnapshotLane, IsByThePicturesOwnGridWhereTheRunSaysNothing) {
  const double shown = shownFreeLane(runThatSays({}));
  EXPECT_GT(shown, 0);
  EXPECT_NE(shown, 7.25);
}

}  // namespace
}  // namespace perception
