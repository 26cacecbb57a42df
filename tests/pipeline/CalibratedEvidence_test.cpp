#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "libperception/pipeline/Pipeline.h"
#include "libperception/sensors/frames/ToObservation.h"

namespace perception {
namespace {

// A camera whose boxes carry calibrated log-odds. Births and clutter are as frequent, so that
// nothing but a box's own score speaks for or against an object; labels have [radecki2016]'s
// precision by day (95 % for cars, 90 % for persons), both classes are as likely.
const char* const kIni = R"(
include = )" PERCEPTION_SOURCE_DIR R"(/ini/classes.ini
[run]
sensors = C
association = ranked
[class.pedestrian]
prior = 0.5
[class.cyclist]
prior = 0.0001
[class.car]
prior = 0.5
[class.bus]
prior = 0.0001
[class.static-other]
prior = 0.0001
[sensor.CAMERA]
kind = boxes
modality = C
clutter_per_scan = 0.1
births_per_scan = 0.1
range_max = 20
fov_deg = 90
label_exponent = 1
precision.car = 0.95
precision.person = 0.90
[sensor.CAMERA.detector]
score_slope = 1
[filter]
height_exponent = 0
)";

CameraModel camera() {
  CameraModel c;
  c.width = 1000, c.height = 600;
  c.fx = c.fy = 600, c.cx = 499.5, c.cy = 299.5;
  return c;
}

/// A box of something 10 m ahead of a camera at 1.6 m, with the probability that it is right. Both
/// its sides are cut by the image: no width speaks for a class, score and label do alone.
ObjectDetection standing(const std::string& label, double right) {
  constexpr double kRange = 10, kEye = 1.6, kHeight = 1.6;  // [m]
  ObjectDetection d;
  d.label = label;
  d.score = std::log(right / (1 - right));
  const CameraModel c = camera();
  const double foot = c.cy + c.fy * kEye / kRange;
  d.image_box = {0, foot - c.fy * kHeight / kRange, c.width - 1.0, foot};
  return d;
}

/// The list of objects after so many images with the box, the surest first.
std::vector<SceneObject> objectsAfter(int images, const ObjectDetection& box) {
  Config config = Config::fromText(kIni, "evidence.ini");
  PipelineSetup setup = PipelineSetup::read(config);
  config.finish();
  setup.scene.min_existence = 0;
  EventLog events;
  RunTiming timing;
  Pipeline pipeline(setup, events, timing);
  std::vector<SceneObject> objects;
  for (int i = 0; i < images; ++i) {
    SensorFrame frame;
    frame.sensor = "CAMERA";
    frame.stamp = Stamp::fromSeconds(1000 + 0.15 * i);
    frame.T_ego_sensor.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    frame.T_ego_sensor.translation() = Vector3(0, 0, 1.6);
    ObjectDetections found;
    found.camera = camera();
    found.objects = {box};
    frame.data = found;
    EgoState ego;
    ego.stamp = frame.stamp;
    pipeline.add(*poseObservation(ego));
    pipeline.add(*observationFromFrame(frame));
  }
  while (auto scene = pipeline.next(true)) objects = scene->objects;
  std::sort(objects.begin(), objects.end(),
            [](const auto& a, const auto& b) { return a.existence > b.existence; });
  return objects;
}

constexpr double kConfirmed = 0.95 - 1e-3;  // the other classes' priors take their 1e-4 each

bool confirmed(const std::vector<SceneObject>& objects) {
  if (objects.empty()) return false;
  const auto& classes = objects[0].class_probability;
  const double surest = *std::max_element(classes.begin(), classes.end());
  return objects[0].existence >= kConfirmed && surest >= kConfirmed;
}

// [radecki2016]: "one car detection or two person detections are sufficient". Nothing in the filter
// counts detections.
TEST(CalibratedEvidence, OneSureCarOrTwoSurePersonsAreEnough) {
  const auto car = standing("Car", 0.95), person = standing("Pedestrian", 0.9);
  EXPECT_TRUE(confirmed(objectsAfter(1, car)));
  EXPECT_FALSE(confirmed(objectsAfter(1, person)));
  EXPECT_TRUE(confirmed(objectsAfter(2, person)));
}

TEST(CalibratedEvidence, DoubtfulBoxesNeedCompany) {
  const auto doubtful = standing("Car", 0.3);
  EXPECT_FALSE(confirmed(objectsAfter(1, doubtful)));
  EXPECT_TRUE(confirmed(objectsAfter(4, doubtful)));
}

TEST(CalibratedEvidence, ExistenceGrowsWithTheScoreAlone) {
  double before = 0;
  for (const double right : {0.05, 0.3, 0.6, 0.9, 0.99}) {
    const auto objects = objectsAfter(1, standing("Car", right));
    const double existence = objects.empty() ? 0 : objects[0].existence;
    EXPECT_GT(existence, before) << right;
    before = existence;
  }
}

}  // namespace
}  // namespace perception
