// Several scanners as one lidar, from the observation to the tracks.
#include <gtest/gtest.h>

#include "libperception/core/Error.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/pipeline/input/FrameQueue.h"
#include "libperception/pipeline/input/MergedScanners.h"
#include "libperception/sensors/frames/ToObservation.h"
#include "tests/support/StartStamp.h"

namespace perception {
namespace {

using test::kStart;

SensorFrame scannerFrame(const std::string& label, double t) {
  SensorFrame frame;
  frame.sensor = label;
  frame.stamp = kStart + t;
  return frame;
}

TEST(FrameQueue, TakesWantedFramesBeforeTheirTurn) {
  FrameQueue queue({0.2, 70});
  queue.push(scannerFrame("A", 0));
  queue.push(scannerFrame("B", 0.02));
  queue.push(scannerFrame("C", 0.03));
  queue.push(scannerFrame("B", 0.1));
  queue.push(scannerFrame("A", 0.3));
  EXPECT_EQ(queue.pop(false).size(), 1U);
  const auto taken = queue.take(kStart + 0.05, [](const std::string& l) { return l == "B"; });
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].stamp.ns, (kStart + 0.02).ns);
  const auto next = queue.pop(true);
  ASSERT_EQ(next.size(), 1U);
  EXPECT_EQ(next[0].sensor, "C");
}

/// A car's rear as one of two scanners sees it: four layers, 1.8 m wide, 12 m ahead.
SensorFrame scanOf(const std::string& label, double t, double y, double from, double to) {
  SensorFrame frame = scannerFrame(label, t);
  frame.T_ego_sensor = makePose(3.8, y, 0.6, 0);
  LidarCloud cloud;
  for (double left = from; left < to; left += 0.06) {
    for (int layer = 0; layer < 4; ++layer) {
      cloud.x.push_back(12);
      cloud.y.push_back(static_cast<float>(left - y));
      cloud.z.push_back(0.15F * static_cast<float>(layer));
      cloud.label.push_back(static_cast<std::uint8_t>(PointLabel::kObject));
      cloud.ring.push_back(static_cast<std::uint16_t>(layer));
    }
  }
  // The road, by its label.
  for (int i = 0; i < 30; ++i) {
    cloud.x.push_back(6);
    cloud.y.push_back(0.2F * static_cast<float>(i - 15));
    cloud.z.push_back(-0.2F);
    cloud.label.push_back(static_cast<std::uint8_t>(PointLabel::kGround));
    cloud.ring.push_back(0);
  }
  frame.data = cloud;
  return frame;
}

PipelineSetup scannerSetup(const std::string& more) {
  Config config = Config::fromFile(PERCEPTION_SOURCE_DIR "/ini/skynet.ini");
  config.set("run.sensors=L");
  config.set("run.output_rate=0");
  config.set("run.without=LIDAR_TOP");
  if (!more.empty()) config.set(more);
  PipelineSetup setup = PipelineSetup::read(config);
  config.finish();
  return setup;
}

TEST(MergedScanners, TwoHalvesOfACarAreOneObject) {
  EventLog events;
  RunTiming timing;
  Pipeline pipeline(scannerSetup(""), events, timing);
  std::size_t objects = 0, scenes = 0;
  for (int k = 0; k < 30; ++k) {
    const double t = 0.08 * k;
    EgoState ego;
    ego.stamp = kStart + t;
    pipeline.add(*poseObservation(ego));
    // The right scanner comes a little later, and first into the log.
    pipeline.add(*observationFromFrame(scanOf("IBEO_RIGHT", t + 0.02, -0.8, -0.9, 0.05)));
    pipeline.add(*observationFromFrame(scanOf("IBEO_LEFT", t, 0.8, 0.0, 0.9)));
    while (const auto scene = pipeline.next()) ++scenes, objects = scene->objects.size();
  }
  while (const auto scene = pipeline.next(true)) ++scenes, objects = scene->objects.size();
  const auto records = pipeline.sensorRecords();
  ASSERT_EQ(records.size(), 1U);
  EXPECT_EQ(records[0].label, "IBEO");
  EXPECT_EQ(records[0].frames, 30U);
  EXPECT_EQ(scenes, 30U);
  EXPECT_EQ(objects, 1U);
}

TEST(MergedScanners, EveryScanIsShownBeforeItIsMerged) {
  const PipelineSetup setup = scannerSetup("");
  FrameQueue queue({0.2, 70});
  queue.push(scanOf("IBEO_RIGHT", 0.02, -0.8, -0.9, 0.05));
  std::vector<std::string> parts;
  mergeScanners(setup.sensors, {scanOf("IBEO_LEFT", 0, 0.8, 0.0, 0.9)}, queue,
                [&](std::size_t sensor, const SensorFrame& part) {
                  EXPECT_EQ(setup.sensors[sensor].label, "IBEO");
                  parts.push_back(part.sensor);
                });
  EXPECT_EQ(parts, (std::vector<std::string>{"IBEO_LEFT", "IBEO_RIGHT"}));
}

TEST(MergedScanners, UnknownLabelsAndTooLongWindowsAreFaults) {
  EXPECT_THROW(scannerSetup("run.without=LIDAR_TOP, NOBODY"), ConfigError);
  EXPECT_THROW(scannerSetup("sensor.IBEO.merge_window=0.5"), ConfigError);
  EXPECT_NO_THROW(scannerSetup("sensor.IBEO.merge_window=0.1"));
}

}  // namespace
}  // namespace perception
