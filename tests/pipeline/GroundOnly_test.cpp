// A lidar that gives the ground plane and nothing else ([sensor.LABEL] ground = only).
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "libperception/measurement/models/FootprintModel.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/sensors/frames/ToObservation.h"

namespace perception {
namespace {

constexpr double kEye = 1.6, kDrop = 0.2;  // [m] camera above the ego origin, road below it

PipelineSetup setupOf(const std::string& ground, const std::string& sensors) {
  Config config = Config::fromText(
      "include = " PERCEPTION_SOURCE_DIR "/ini/classes.ini\n[run]\nsensors = " + sensors +
          "\n[sensor.LIDAR]\nkind = lidar\nmodality = L\nground = " + ground +
          "\n[sensor.CAMERA]\nkind = boxes\nmodality = C\n",
      "ground.ini");
  PipelineSetup setup = PipelineSetup::read(config);
  config.finish();
  return setup;
}

SensorFrame frameOf(const std::string& label, double t) {
  SensorFrame frame;
  frame.sensor = label;
  frame.stamp = Stamp::fromSeconds(1000 + t);
  return frame;
}

/// A flat road kDrop below the ego origin, as a lidar 2 m above it sees it.
SensorFrame flatRoadAt(double t) {
  SensorFrame frame = frameOf("LIDAR", t);
  frame.T_ego_sensor = makePose(0, 0, 2, 0);
  LidarCloud cloud;
  for (int ring = 0; ring < 20; ++ring) {
    for (int step = 0; step < 360; ++step) {
      const double range = 5 + ring, azimuth = radians(step);
      cloud.x.push_back(static_cast<float>(range * std::cos(azimuth)));
      cloud.y.push_back(static_cast<float>(range * std::sin(azimuth)));
      cloud.z.push_back(static_cast<float>(-2 - kDrop));
      cloud.ring.push_back(static_cast<std::uint16_t>(19 - ring));
    }
  }
  frame.data = cloud;
  return frame;
}

/// The box of a car whose foot lies 10 m ahead on a road at the ego origin's height.
SensorFrame emptyImageAt(double t) {
  SensorFrame frame = frameOf("CAMERA", t);
  frame.T_ego_sensor.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  frame.T_ego_sensor.translation() = Vector3(0, 0, kEye);
  ObjectDetections found;
  found.camera.width = 1000, found.camera.height = 600;
  found.camera.fx = found.camera.fy = 600;
  found.camera.cx = 499.5, found.camera.cy = 299.5;
  ObjectDetection car;
  car.label = "car";
  const double foot = found.camera.cy + found.camera.fy * kEye / 10;
  car.image_box = {450, foot - 90, 550, foot};
  found.objects = {car};
  frame.data = found;
  return frame;
}

/// What the filter got.
class Scans : public PipelineObserver {
 public:
  void onScan(const MeasurementScan& scan) override { seen.push_back(scan); }
  std::vector<MeasurementScan> seen;
};

struct Recorded {
  std::vector<MeasurementScan> scans;
  std::vector<SensorRecord> records;
};

Recorded runOf(const std::string& ground, const std::string& sensors = "C") {
  EventLog events;
  RunTiming timing;
  Scans scans;
  Pipeline pipeline(setupOf(ground, sensors), events, timing);
  pipeline.observe(&scans);
  for (int i = 0; i < 10; ++i) {
    EgoState ego;
    ego.stamp = Stamp::fromSeconds(1000 + 0.1 * i);
    pipeline.add(*poseObservation(ego));
    pipeline.add(*observationFromFrame(flatRoadAt(0.1 * i)));
    pipeline.add(*observationFromFrame(emptyImageAt(0.1 * i + 0.01)));
  }
  while (pipeline.next(true)) continue;
  return {scans.seen, pipeline.sensorRecords()};
}

double lastRange(const Recorded& run) {
  return run.scans.back().measurements.at(0).z[FootprintModel::kRange];
}

TEST(GroundOnly, AnUnusedLidarTellsTheCamerasGround) {
  const Recorded flat = runOf("true"), measured = runOf("only");
  EXPECT_NEAR(lastRange(flat), 10, 0.2);
  EXPECT_NEAR(lastRange(measured), 10 * (kEye + kDrop) / kEye, 0.2);
}

TEST(GroundOnly, NoneOfItsScansReachesTheFilter) {
  for (const char* sensors : {"C", "C+L"}) {
    const Recorded run = runOf("only", sensors);
    ASSERT_EQ(run.scans.size(), 10U) << sensors;
    for (const auto& scan : run.scans) EXPECT_EQ(scan.sensor, "CAMERA") << sensors;
    ASSERT_EQ(run.records.size(), 2U);
    EXPECT_EQ(run.records[0].label, "LIDAR");
    EXPECT_EQ(run.records[0].frames, 10U);
    EXPECT_EQ(run.records[0].measurements, 0U);
  }
}

TEST(GroundOnly, OtherwiseAnUnusedLidarIsNotRead) {
  for (const char* ground : {"true", "false"}) {
    const Recorded run = runOf(ground);
    ASSERT_EQ(run.records.size(), 1U) << ground;
    EXPECT_EQ(run.records[0].label, "CAMERA");
  }
}

}  // namespace
}  // namespace perception
