#include "libperception/pipeline/watches/LogWatchers.h"

#include <gtest/gtest.h>

#include <set>

#include "libperception/sensors/frames/ToObservation.h"

namespace perception {
namespace {

SensorFrame boxFrame() {
  ObjectDetections found;
  found.camera.fx = found.camera.fy = 720;
  found.camera.width = 1242;
  found.camera.height = 375;
  ObjectDetection& object = found.objects.emplace_back();
  object.label = "Car";
  object.space_box.emplace();
  object.space_box->bottom_center = Vector3(10, 0, 0);
  object.space_box->length = object.space_box->width = object.space_box->height = 2;
  SensorFrame frame;
  frame.sensor = "boxes3d";
  frame.stamp = Stamp::fromSeconds(1000);
  frame.T_ego_sensor = makePose(0, 0, 1.7, 0);
  frame.data = found;
  return frame;
}

TEST(LogFacts, TheCameraOf3dBoxesIsWhereTheLogSaysThatItIs) {
  SensorFrame frame = boxFrame();
  LogFacts without;
  without.look(*observationFromFrame(frame));
  EXPECT_FALSE(without.camera) << "the boxes' own frame is no camera";
  std::get<ObjectDetections>(frame.data).T_ego_camera = makePose(0.3, 0.1, 1.6, 0);
  LogFacts with;
  with.look(*observationFromFrame(frame));
  ASSERT_TRUE(with.camera);
  EXPECT_EQ(with.camera->camera.width, 1242);
  EXPECT_TRUE(with.camera->T_ego_camera.isApprox(makePose(0.3, 0.1, 1.6, 0), 1e-9));
}

constexpr Stamp kLogStart{1700000000000000000};

ClassTable cars() {
  ClassTable table;
  table.classes.resize(1);
  table.classes[0].name = "car";
  return table;
}

/// Each object is in three scenes; every second one is classified in its second one.
Scene sceneOf(std::uint64_t number) {
  Scene scene;
  scene.stamp = Stamp{kLogStart.ns + static_cast<std::int64_t>(number) * 100000000};
  for (std::uint64_t id = number > 2 ? number - 2 : 1; id <= number; ++id) {
    SceneObject object;
    object.id = id;
    object.classified = id % 2 == 0 && id < number;
    scene.objects.push_back(object);
  }
  return scene;
}

TEST(ObjectEvents, ForgettingTheDeadChangesNoEventAndBoundsTheirNumber) {
  const ClassTable classes = cars();
  EventLog all_events, few_events;
  ObjectEvents all(classes, all_events), few(classes, few_events);
  int forgotten = 0;
  for (std::uint64_t i = 1; i < 10 * ObjectEvents::kFewIds; ++i) {
    const Scene scene = sceneOf(i);
    all.add(scene);
    few.add(scene);
    if (!few.isFull()) continue;
    std::set<std::uint64_t> living;
    for (const auto& object : scene.objects) living.insert(object.id);
    few.keepOnly(living);
    EXPECT_FALSE(few.isFull());
    ++forgotten;
  }
  EXPECT_GE(forgotten, 8);
  EXPECT_TRUE(all.isFull());
  EXPECT_EQ(few.objects(), 10 * ObjectEvents::kFewIds - 1);
  EXPECT_EQ(few.objects(), all.objects());
  EXPECT_EQ(few_events.text(kLogStart), all_events.text(kLogStart));
}

}  // namespace
}  // namespace perception
