// What a user adds without a change to the library: a class, a modality with its front end.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/measurement/models/PositionModel.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/scene/files/TrackedRun.h"
#include "libperception/sensors/frames/ToObservation.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

constexpr Modality kUltrasonic = static_cast<Modality>('U');
constexpr int kCones = 12;  // of a ring around the vehicle

/// A ring of ultrasonic sensors: each tells the range to the nearest point in a wide cone. Place as
/// measured: on the cone's axis, unsure by the cone's width across it.
class UltrasonicFrontEnd final : public FrontEnd {
 public:
  explicit UltrasonicFrontEnd(const PositionModel::Params& params)
      : model_(std::make_shared<const PositionModel>(params)) {}
  std::vector<std::string> labelNames() const override { return {"echo"}; }

 protected:
  Modality modality() const override { return kUltrasonic; }
  std::shared_ptr<const MeasurementModel> model() const override { return model_; }
  void fill(const SensorFrame& frame, MeasurementScan& scan) const override {
    constexpr double kRangeSigma = 0.1;  // [m]
    const auto* echoes = std::get_if<RadarReturns>(&frame.data);
    if (echoes == nullptr) return;
    for (const RadarReturn& echo : echoes->returns) {
      const double axis = yawOf(scan.state.T_world_sensor) + echo.bearing;
      const Vector2 along(std::cos(axis), std::sin(axis)), across(-along.y(), along.x());
      const double width = echo.range * kTwoPi / kCones / std::sqrt(12.0);
      Measurement m;
      m.label = 0;
      m.position = scan.state.T_world_sensor.translation().head<2>() + echo.range * along;
      m.position_sigma = width;
      m.z = m.position;
      m.seen = 3;
      m.R = kRangeSigma * kRangeSigma * along * along.transpose() +
            width * width * across * across.transpose();
      m.detection = static_cast<int>(scan.measurements.size());
      scan.measurements.push_back(std::move(m));
    }
  }

 private:
  std::shared_ptr<const PositionModel> model_;
};

std::unique_ptr<FrontEnd> makeUltrasonicFrontEnd(Config& config, const std::string& label,
                                                 const ClassTable& classes) {
  DetectionParams defaults;
  defaults.kind = "ultrasonic";
  defaults.modality = kUltrasonic;
  const DetectionModel table =
      DetectionModel::read(config, "sensor." + label, classes, {"echo"}, defaults);
  PositionModel::Params params;
  for (ClassId c = 0; c < classes.size(); ++c) {
    PositionModel::ClassRow row;
    row.detection = table.row(c).detection;
    row.labels = {1};
    row.noise.setZero();
    row.extent = {classes[c].length, classes[c].width, 0.01, 0.01};
    params.classes.push_back(row);
  }
  params.clutter_labels = {1};
  params.clutter_per_scan = table.params().clutter_per_scan;
  params.births_per_scan = table.params().births_per_scan;
  params.range = table.params().range_max;
  params.fov = table.params().fov;
  return std::make_unique<UltrasonicFrontEnd>(params);
}

/// As a program does before it reads its configuration.
void addUltrasonic() {
  ModalityRow row;
  row.letter = kUltrasonic;
  row.name = "ultrasonic";
  addModality(row);
  auto& table = frontEnds();
  const auto there = [](const FrontEndRow& r) { return r.kind == "ultrasonic"; };
  if (std::none_of(table.begin(), table.end(), there))
    table.push_back({"ultrasonic", &makeUltrasonicFrontEnd});
}

const std::string kClasses = R"(
include = )" PERCEPTION_SOURCE_DIR R"(/ini/classes.ini
[class.robot]                ; a delivery robot
motion = constant-velocity
accel_psd = 0.3
length = 0.8
width = 0.6
height = 1.0
max_speed = 3
prior = 0.3
)";

const std::string kRing = R"(
[run]
sensors = U
[detection.ultrasonic.robot]
detection = 0.95
[detection.ultrasonic.pedestrian]
detection = 0.2              ; clothes swallow sound
[detection.ultrasonic.cyclist]
detection = 0.2
[detection.ultrasonic.car]
detection = 0.4
[detection.ultrasonic.bus]
detection = 0.4
[detection.ultrasonic.static-other]
detection = 0.2
[sensor.RING]
kind = ultrasonic
modality = U
range_max = 10
detection_exponent = 1
)";

const std::string kBoxes = R"(
[run]
sensors = L
[sensor.BOXES]
kind = positions
modality = L
range_max = 40
label_exponent = 1
[sensor.BOXES.positions]
labels = robot, other
names = Robot=robot, Other=other
[sensor.BOXES.class.robot]
label.robot = 0.9
[sensor.BOXES.class.pedestrian]
label.robot = 0.1
[sensor.BOXES.class.cyclist]
label.robot = 0.1
[sensor.BOXES.class.car]
label.robot = 0.1
[sensor.BOXES.class.bus]
label.robot = 0.1
[sensor.BOXES.class.static-other]
label.robot = 0.1
)";

PipelineSetup extendedSetup(const std::string& ini) {
  Config config = Config::fromText(ini, "extended.ini");
  PipelineSetup setup = PipelineSetup::read(config);
  config.finish();
  return setup;
}

/// Where the robot is at t [s]: it passes before the vehicle.
Vector2 robotAt(double t) { return {5, -3 + 1.0 * t}; }

SensorFrame ringAt(double t) {
  RadarReturn echo;
  const double cone = kTwoPi / kCones;
  echo.bearing = cone * std::round(std::atan2(robotAt(t).y(), robotAt(t).x()) / cone);
  echo.range = robotAt(t).norm();
  echo.has_rate = false;
  SensorFrame frame;
  frame.sensor = "RING";
  frame.data = RadarReturns{{echo}, 10};
  return frame;
}

SensorFrame boxAt(double t) {
  ObjectDetection robot;
  robot.label = "Robot";
  robot.space_box = ObjectDetection::SpaceBox{{robotAt(t).x(), robotAt(t).y(), 0}, 0, 0.8, 0.6, 1};
  SensorFrame frame;
  frame.sensor = "BOXES";
  ObjectDetections found;
  found.objects = {robot};
  frame.data = found;
  return frame;
}

constexpr double kStartSeconds = 1000;  // [s]

/// Scenes of five seconds at 10 Hz of a vehicle that stands.
template <class FrameAt>
std::vector<Scene> scenesOf(const PipelineSetup& setup, FrameAt frameAt) {
  EventLog events;
  RunTiming timing;
  Pipeline pipeline(setup, events, timing);
  for (int i = 0; i <= 50; ++i) {
    SensorFrame frame = frameAt(0.1 * i);
    frame.stamp = Stamp::fromSeconds(kStartSeconds + 0.1 * i);
    EgoState ego;
    ego.stamp = frame.stamp;
    pipeline.add(*poseObservation(ego));
    pipeline.add(*observationFromFrame(frame));
  }
  std::vector<Scene> scenes;
  while (auto scene = pipeline.next(true)) scenes.push_back(std::move(*scene));
  return scenes;
}

TEST(Extending, AClassIsASectionOfTheIni) {
  const PipelineSetup setup = extendedSetup(kClasses + kBoxes);
  const auto scenes = scenesOf(setup, boxAt);
  ASSERT_EQ(scenes.size(), 51U);
  ASSERT_EQ(scenes.back().objects.size(), 1U);
  const SceneObject& robot = scenes.back().objects[0];
  EXPECT_EQ(setup.model.classes[robot.class_id].name, "robot");
  EXPECT_TRUE(robot.classified);
  EXPECT_NEAR((robot.position.head<2>() - robotAt(5)).norm(), 0, 0.3);
}

TEST(Extending, AModalityIsARowWithAFrontEnd) {
  addUltrasonic();
  const PipelineSetup setup = extendedSetup(kClasses + kRing);
  const auto scenes = scenesOf(setup, ringAt);
  ASSERT_EQ(scenes.size(), 51U);
  ASSERT_EQ(scenes.back().objects.size(), 1U);
  const SceneObject& robot = scenes.back().objects[0];
  EXPECT_EQ(setup.model.classes[robot.class_id].name, "robot");
  EXPECT_NEAR((robot.position.head<2>() - robotAt(5)).norm(), 0, 1);
  ASSERT_EQ(robot.last_hit.size(), 1U);
  EXPECT_EQ(robot.last_hit.at(kUltrasonic).ns, Stamp::fromSeconds(kStartSeconds + 5).ns);
}

TEST(Extending, AnAddedModalityHasItsColumnBehindTheOthers) {
  addUltrasonic();
  const PipelineSetup setup = extendedSetup(kClasses + kRing);
  const auto scenes = scenesOf(setup, ringAt);
  const test::TemporaryFolder folder;
  TrackedRunWriter writer(folder.path(), setup.model.classes, scenes.front().stamp);
  for (const Scene& scene : scenes) writer.write(scene);
  writer.close();
  const auto header = CsvTable::fromFile(folder / "tracks.csv").header();
  const std::vector<std::string> last(header.end() - 4, header.end());
  EXPECT_EQ(last,
            (std::vector<std::string>{"last_hit_C", "last_hit_L", "last_hit_R", "last_hit_U"}));
  const TrackedRun run = readTrackedRun(folder.path());
  EXPECT_EQ(run.scenes.back().objects.at(0).last_hit.count(kUltrasonic), 1U);
}

TEST(Extending, ASensorSetNamesKnownLettersOnly) {
  addUltrasonic();
  EXPECT_NO_THROW(extendedSetup(kClasses + kRing));
  std::string other = kRing;
  other.replace(other.find("sensors = U"), 11, "sensors = X");
  EXPECT_THROW(extendedSetup(kClasses + other), ConfigError);
}

}  // namespace
}  // namespace perception
