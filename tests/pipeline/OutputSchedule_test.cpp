#include "libperception/pipeline/OutputSchedule.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

constexpr Stamp kStart{1'577'836'800'000'000'000};

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
  EXPECT_FALSE(outputs.isOutput(kStart + 5, true));
  EXPECT_FALSE(outputs.takeBefore(kStart + 5));
  EXPECT_EQ(outputs.takeBefore(kStart + 5.15)->ns, (kStart + 5).ns);
  EXPECT_EQ(outputs.takeBefore(kStart + 5.15)->ns, (kStart + 5.1).ns);
  EXPECT_FALSE(outputs.takeBefore(kStart + 5.15));
}

TEST(OutputSchedule, AnInstantWaitsForItsLag) {
  RunParams run;
  run.output_lag = 0.5;
  OutputSchedule outputs(run, {sensor("L", Modality::kLidar)});
  EXPECT_TRUE(outputs.isOutput(kStart, true));
  EXPECT_FALSE(outputs.isOutput(kStart, false));
  outputs.push({egoAt(0), 7, {}});
  outputs.push({egoAt(1), 8, {}});
  EXPECT_FALSE(outputs.takeDue(kStart + 0.4));
  EXPECT_EQ(outputs.takeDue(kStart + 0.6)->frame, 7);
  EXPECT_FALSE(outputs.takeDue(kStart + 0.6));
  EXPECT_EQ(outputs.takeDue(std::nullopt)->frame, 8);
}

}  // namespace
}  // namespace perception
