#include "libperception/pipeline/output/OutputSchedule.h"
#include "tests/support/StartStamp.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

using test::kStart;

PipelineSetup::Sensor sensor(const char* label, Modality modality, bool active = true) {
  PipelineSetup::Sensor s;
  s.label = label;
  s.params.modality = modality;
  s.active = active;
  return s;
}

EgoState egoAt(double t) {
  EgoState ego;
  ego.stamp = kStart + t;
  return ego;
}

TEST(OutputSchedule, TheFirstLidarInUseSetsThePace) {
  const std::vector<PipelineSetup::Sensor> sensors = {
      sensor("R", Modality::kRadar), sensor("UNUSED", Modality::kLidar, false),
      sensor("L1", Modality::kLidar), sensor("L2", Modality::kLidar)};
  RunParams run;
  EXPECT_EQ(OutputSchedule(run, sensors).sensor(), 2U);
  run.output_sensor = "R";
  EXPECT_EQ(OutputSchedule(run, sensors).sensor(), 0U);
  run.output_sensor = "L2";
  EXPECT_EQ(OutputSchedule(run, sensors).sensor(), 3U);
}

TEST(OutputSchedule, WithoutALidarTheFirstSensorInUseDoes) {
  const std::vector<PipelineSetup::Sensor> sensors = {sensor("UNUSED", Modality::kCamera, false),
                                                      sensor("R", Modality::kRadar),
                                                      sensor("C", Modality::kCamera)};
  EXPECT_EQ(OutputSchedule({}, sensors).sensor(), 1U);
}

TEST(OutputSchedule, AFixedRateBeginsAtTheFirstInstantWithFrames) {
  RunParams run;
  run.output_rate = 10;
  OutputSchedule outputs(run, {sensor("L", Modality::kLidar)});
  EXPECT_FALSE(outputs.takeBefore(kStart + 5));
  outputs.addFrame(0, kStart + 5);
  EXPECT_FALSE(outputs.isOutput(kStart + 5));
  EXPECT_FALSE(outputs.takeBefore(kStart + 5));
  EXPECT_EQ(outputs.takeBefore(kStart + 5.15)->ns, (kStart + 5).ns);
  EXPECT_EQ(outputs.takeBefore(kStart + 5.15)->ns, (kStart + 5.1).ns);
  EXPECT_FALSE(outputs.takeBefore(kStart + 5.15));
}

TEST(OutputSchedule, AnInstantWaitsForItsLag) {
  RunParams run;
  run.output_lag = 0.5;
  OutputSchedule outputs(run, {sensor("L", Modality::kLidar)});
  outputs.addFrame(0, kStart);
  EXPECT_TRUE(outputs.isOutput(kStart));
  EXPECT_FALSE(outputs.isOutput(kStart + 0.01));
  outputs.push({egoAt(0), 7, {}});
  outputs.push({egoAt(1), 8, {}});
  EXPECT_FALSE(outputs.takeDue(kStart + 0.4));
  EXPECT_EQ(outputs.takeDue(kStart + 0.6)->frame, 7);
  EXPECT_FALSE(outputs.takeDue(kStart + 0.6));
  EXPECT_EQ(outputs.takeDue(std::nullopt)->frame, 8);
}

/// Lidar and camera have a frame every 0.1 s, the camera 0.05 s after the lidar, which is silent
/// from 2 s to 5 s.
TEST(OutputSchedule, WhileTheOutputSensorIsSilentTheNextOneSetsThePace) {
  OutputSchedule outputs({}, {sensor("L", Modality::kLidar), sensor("C", Modality::kCamera)});
  std::vector<int> at_lidar(8), at_camera(8);  // by second
  for (int k = 0; k < 80; ++k) {
    const Stamp lidar = kStart + 0.1 * k, camera = lidar + 0.05;
    if (k < 20 || k >= 50) {
      outputs.addFrame(0, lidar);
      at_lidar[static_cast<std::size_t>(k / 10)] += outputs.isOutput(lidar);
    }
    outputs.addFrame(1, camera);
    at_camera[static_cast<std::size_t>(k / 10)] += outputs.isOutput(camera);
  }
  EXPECT_EQ(at_lidar, (std::vector<int>{10, 10, 0, 0, 0, 10, 10, 10}));
  EXPECT_EQ(at_camera, (std::vector<int>{0, 0, 1, 10, 10, 0, 0, 0})) << "from 1 s of silence on";
}

TEST(OutputSchedule, ASensorThatNeverCameIsSilent) {
  OutputSchedule outputs({}, {sensor("L", Modality::kLidar), sensor("C", Modality::kCamera)});
  int scenes = 0;
  for (int k = 0; k < 30; ++k) {
    outputs.addFrame(1, kStart + 0.1 * k);
    scenes += outputs.isOutput(kStart + 0.1 * k);
  }
  EXPECT_EQ(scenes, 19);
  EXPECT_EQ(outputs.sensor(), 1U);
}

TEST(OutputSchedule, WhereNothingComesFromAnySensorNoneIsSilent) {
  OutputSchedule outputs({}, {sensor("L", Modality::kLidar), sensor("C", Modality::kCamera)});
  outputs.addFrame(0, kStart);
  EXPECT_TRUE(outputs.isOutput(kStart));
  outputs.addFrame(1, kStart + 60);
  EXPECT_FALSE(outputs.isOutput(kStart + 60)) << "the lidar comes 0.1 s later";
  outputs.addFrame(0, kStart + 60.1);
  EXPECT_TRUE(outputs.isOutput(kStart + 60.1));
}

}  // namespace
}  // namespace perception
