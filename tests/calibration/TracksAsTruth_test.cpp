#include "libperception/calibration/TracksAsTruth.h"

#include <gtest/gtest.h>

#include "tests/evaluation/MakeRun.h"

namespace perception {
namespace {

using namespace testing_evaluation;

constexpr int kScenes = 20, kLastHit = 15;

/// Scenes of one object, last measured at kLastHit.
TrackedRun runOf(SceneObject object) {
  TrackedRun run = makeRun();
  for (int k = 0; k < kScenes; ++k) {
    Scene scene = makeScene(k, {object});
    if (k <= kLastHit) object.last_hit[Modality::kLidar] = scene.stamp;
    scene.objects[0].last_hit = object.last_hit;
    run.scenes.push_back(std::move(scene));
  }
  return run;
}

TruthObject only(const GroundTruth& truth, std::size_t instant) {
  EXPECT_EQ(truth.instants.at(instant).objects.size(), 1U);
  return truth.instants[instant].objects.at(0);
}

TEST(TracksAsTruth, AnObjectCountsBetweenItsFirstSceneAndItsLastMeasurement) {
  const GroundTruth truth = tracksAsTruth(runOf(makeObject(7, 20, 1)), 3);
  ASSERT_EQ(truth.instants.size(), 20U);
  for (int k = 0; k < kScenes; ++k) {
    const TruthObject label = only(truth, static_cast<std::size_t>(k));
    EXPECT_EQ(label.type, "car");
    EXPECT_EQ(label.id, 7);
    EXPECT_EQ(label.occluded, 3);
    EXPECT_EQ(label.ignore, k == 0 || k >= kLastHit) << k;
  }
}

TEST(TracksAsTruth, WhatIsNotSureIsUnknown) {
  EXPECT_EQ(only(tracksAsTruth(runOf(makeObject(7, 20, 1, kCar, 0.7)), 0), 5).type, "unknown");
  SceneObject doubtful = makeObject(7, 20, 1);
  doubtful.existence = 0.8;
  EXPECT_EQ(only(tracksAsTruth(runOf(doubtful), 0), 5).type, "unknown");
  TrackedRun shortlived = runOf(makeObject(7, 20, 1));
  shortlived.scenes.resize(8);
  EXPECT_EQ(only(tracksAsTruth(shortlived, 0), 5).type, "unknown");
}

TEST(WithTracks, AddsThingsThatNoLabelIsNear) {
  TrackedRun run = makeRun();
  for (int k = 0; k < kScenes; ++k) {
    const Stamp stamp = makeScene(k).stamp;
    std::vector<SceneObject> objects = {makeObject(1, 20, 1), makeObject(2, 30, 5, kStaticOther),
                                        makeObject(3, 40, -6)};
    for (SceneObject& o : objects) o.last_hit[Modality::kLidar] = stamp;
    run.scenes.push_back(makeScene(k, objects));
  }
  GroundTruth labeled;
  GroundTruth::Instant instant;
  instant.frame = 5, instant.t = 0.5;
  instant.objects = {makeTruth(5, 1, 20.5, 1)};
  labeled.instants.push_back(instant);
  const GroundTruth truth = withTracks(labeled, run, 0);
  ASSERT_EQ(truth.instants.size(), 1U) << "instants without labels say nothing of road users";
  std::map<std::string, std::int64_t> ids;
  for (const TruthObject& o : truth.instants[0].objects) ids[o.type] = o.id;
  EXPECT_EQ(ids, (std::map<std::string, std::int64_t>{
                     {"Car", 1}, {"static-other", -3}, {"unknown", -4}}));
}

}  // namespace
}  // namespace perception
