#include "libperception/pipeline/LogWatchers.h"

#include <gtest/gtest.h>

#include "libperception/sensors/ToObservation.h"

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

}  // namespace
}  // namespace perception
