#include "libperception/vision/BoxGeometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "libperception/vision/VisionFrontEnd.h"

namespace perception {
namespace {

const CameraModel kCamera{1242, 700, 720, 720, 610, 173};

/// An optical frame at height h, looking forward and `down` [rad].
Pose3 cameraPose(double height, double down = 0) {
  Pose3 optical = Pose3::Identity();
  optical.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // x right, y down, z forward in the ego frame
  Pose3 pose = makePose(0.3, 0, height, 0, down, 0);
  pose.linear() = pose.linear() * optical.linear();
  return pose;
}

Vector2 project(const Vector3& ego, const Pose3& T_ego_camera) {
  const Vector3 p = T_ego_camera.inverse() * ego;
  return {kCamera.fx * p.x() / p.z() + kCamera.cx, kCamera.fy * p.y() / p.z() + kCamera.cy};
}

/// The image box of a flat board at x = distance, from y = right to y = left, `height` tall.
ObjectDetection::ImageBox boardBox(double distance, double left, double right, double height,
                                   const Pose3& pose, const GroundPlane& ground = {}) {
  const double z = ground.heightAt(distance, 0);
  const Vector2 a = project({distance, left, z + height}, pose),
                b = project({distance, right, z}, pose);
  return {a.x(), a.y(), b.x(), b.y()};
}

TEST(BoxGeometry, RecoversBearingsRangeAndHeightOfAStandingBoard) {
  for (const double down : {0.0, 0.03}) {
    for (const double distance : {6.0, 12.0, 25.0}) {
      const Pose3 pose = cameraPose(1.65, down);
      const auto out =
          boxOnGround(boardBox(distance, 0.9, -0.7, 1.5, pose), kCamera, pose, {}, {}, {});
      ASSERT_TRUE(out && out->range);
      const double ahead = distance - 0.3;
      EXPECT_NEAR(out->left, std::atan2(0.9, ahead), 2e-3);
      EXPECT_NEAR(out->right, std::atan2(-0.7, ahead), 2e-3);
      EXPECT_NEAR(*out->range, ahead, 0.02 * ahead);
      EXPECT_NEAR(out->height, 1.5, 0.05);
    }
  }
}

TEST(BoxGeometry, TakesTheGroundItIsGiven) {
  GroundPlane slope;
  slope.a = 0.04;  // the road rises
  const Pose3 pose = cameraPose(1.65);
  const auto box = boardBox(15, 0.8, -0.8, 1.5, pose, slope);
  const auto right = boxOnGround(box, kCamera, pose, slope, {}, {});
  const auto flat = boxOnGround(box, kCamera, pose, {}, {}, {});
  ASSERT_TRUE(right && right->range);
  EXPECT_NEAR(*right->range, 14.7, 0.3);
  EXPECT_TRUE(!flat->range || *flat->range > 20);  // a rise taken for flat ground puts it far away
}

TEST(BoxGeometry, RangeIsAsUncertainAsPitchMakesIt) {
  BoxGeometryParams p;
  p.bottom_sigma = 0.1;
  p.bottom_share = 0;
  p.range_floor = 0;
  p.pitch_sigma = radians(1);
  PoseUncertainty sure;
  sure.sigma_pitch = 0;
  const Pose3 pose = cameraPose(2.5);
  // method.md 4.2: one degree of pitch is .5 m at 8 m and 1.6 m at 15 m for a camera at 2.5 m.
  const auto at = [&](double range) {
    return boxOnGround(boardBox(range + 0.3, 0.5, -0.5, 1, pose), kCamera, pose, {}, sure, p)
        ->range_sigma;
  };
  EXPECT_NEAR(at(8), 0.49, 0.03);
  EXPECT_NEAR(at(15), 1.6, 0.05);
}

TEST(BoxGeometry, AUsualHeightTellsTheRangeWherePitchSpoilsTheGround) {
  const Pose3 pitched = cameraPose(1.65, radians(1)), assumed = cameraPose(1.65);
  const auto box = boardBox(30.3, 0.9, -0.9, 1.5, pitched);  // 30 m from the camera
  const ScalarEstimate usual{1.5, 0.1 * 0.1};
  const auto ground = boxOnGround(box, kCamera, assumed, {}, {}, {});
  const auto both = boxOnGround(box, kCamera, assumed, {}, {}, {}, usual);
  ASSERT_TRUE(ground->range && both->range);
  EXPECT_GT(std::abs(*ground->range - 30), 5);
  EXPECT_NEAR(*both->range, 30, 3);
  EXPECT_LT(both->range_sigma, ground->range_sigma);
  // Lower end and height at that range give the box's own rows again.
  EXPECT_NEAR(both->height, 1.5 * *both->range / 30, 0.05);
}

TEST(BoxGeometry, AnUnusualHeightLeavesTheRangeToTheGround) {
  const Pose3 pose = cameraPose(1.65);
  const auto van = boardBox(12.3, 0.9, -0.9, 3, pose);
  BoxGeometryParams sharp;
  sharp.bottom_sigma = 1;
  sharp.bottom_share = 0.02;
  const auto box = boxOnGround(van, kCamera, pose, {}, {}, sharp, ScalarEstimate{1.5, 0.1 * 0.1});
  EXPECT_NEAR(*box->range, 12, 0.1);
  EXPECT_NEAR(box->height, 3, 0.05);
}

TEST(BoxGeometry, EdgesAtTheBorderOfTheImageAreNotSeen) {
  const Pose3 pose = cameraPose(1.65);
  const auto left = boxOnGround({0, 150, 100, 300}, kCamera, pose, {}, {}, {});
  EXPECT_FALSE(left->left_seen);
  EXPECT_TRUE(left->right_seen && left->range);
  const auto bottom = boxOnGround({500, 150, 700, 699}, kCamera, pose, {}, {}, {});
  EXPECT_FALSE(bottom->range);
  EXPECT_TRUE(bottom->left_seen);
  const auto above = boxOnGround({500, 20, 520, 60}, kCamera, pose, {}, {}, {});
  EXPECT_FALSE(above->range);  // its foot lies above the horizon
}

TEST(BoxGeometry, RefusesABoxThatIsNone) {
  const Pose3 pose = cameraPose(1.65);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(boxOnGround({100, 100, 90, 200}, kCamera, pose, {}, {}, {}));
  EXPECT_FALSE(boxOnGround({nan, 100, 190, 200}, kCamera, pose, {}, {}, {}));
}

TEST(VisionFrontEnd, SureBoxesHideWhatStandsBehindThem) {
  Config config = Config::fromText(
      "[class.car]\nmotion = wheeled\n[class.pedestrian]\nmotion = constant-velocity\n"
      "[sensor.A]\nkind = boxes\nmodality = C\n[sensor.A.detector]\noccluder_score = 0.5\n",
      "a.ini");
  const ClassTable classes = readClassTable(config);
  const auto front_end = makeVisionFrontEnd(config, "A", classes);
  SensorFrame frame;
  frame.sensor = "A";
  frame.T_ego_sensor = cameraPose(1.65);
  const auto occlusionAt = [&](double score) {
    ObjectDetections detections;
    detections.camera = kCamera;
    ObjectDetection o;
    o.label = "Pedestrian";
    o.score = score;
    o.image_box = boardBox(12, 0.4, -0.4, 1.7, frame.T_ego_sensor);
    detections.objects.push_back(o);
    frame.data = detections;
    return front_end->extract(frame).occlusion;
  };
  const auto sure = occlusionAt(0.9), doubtful = occlusionAt(0.3);
  ASSERT_TRUE(sure && doubtful);
  EXPECT_EQ(sure->visibility(-0.02, 0.02, 15, 0.5), 0);
  EXPECT_EQ(sure->visibility(-0.02, 0.02, 11, 0.5), 1);
  EXPECT_EQ(sure->visibility(0.1, 0.2, 15, 0.5), 1);
  EXPECT_EQ(doubtful->visibility(-0.02, 0.02, 15, 0.5), 1);
}

ObjectDetection detectionOf(const std::string& label, double score,
                            const ObjectDetection::ImageBox& box) {
  ObjectDetection o;
  o.label = label;
  o.score = score;
  o.image_box = box;
  return o;
}

const Pose3 kCameraPose = cameraPose(1.65);

/// What the front end of sensor A makes of these boxes, with the classes and keys of an INI.
MeasurementScan scanOf(const std::string& ini, std::vector<ObjectDetection> objects) {
  Config config = Config::fromText(ini, "a.ini");
  const auto front_end = makeVisionFrontEnd(config, "A", readClassTable(config));
  EXPECT_NO_THROW(config.finish());
  SensorFrame frame;
  frame.sensor = "A";
  frame.T_ego_sensor = kCameraPose;
  ObjectDetections detections;
  detections.camera = kCamera;
  detections.objects = std::move(objects);
  frame.data = detections;
  return front_end->extract(frame);
}

/// One box of a pedestrian by a detector with these keys.
MeasurementScan scanOf(const std::string& detector, double score) {
  return scanOf(
      "[class.pedestrian]\nmotion = constant-velocity\n[class.cyclist]\nmotion = wheeled\n"
      "[class.car]\nmotion = wheeled\n[class.pole]\nmotion = static\nreported = false\n"
      "[sensor.A]\nkind = boxes\nmodality = C\n[sensor.A.class.pedestrian]\nlabel.person = 0.9\n"
      "[sensor.A.class.cyclist]\nlabel.person = 0.6\n[sensor.A.class.car]\nlabel.car = 0.8\n"
      "[sensor.A.class.pole]\nlabel.person = 0.5\n[sensor.A.detector]\nscore_slope = 2\n"
      "score_offset = 0.5\n" +
          detector,
      {detectionOf("Pedestrian", score, boardBox(12, 0.4, -0.4, 1.7, kCameraPose))});
}

TEST(VisionFrontEnd, ScoresAreEvidenceAgainstThings) {
  const MeasurementScan scan = scanOf("score_by_class = true\n", 0.9);
  ASSERT_EQ(scan.measurements.size(), 1u);
  const auto& log_class = scan.measurements[0].log_class;
  ASSERT_EQ(log_class.size(), 4u);
  EXPECT_NEAR(log_class[0], std::log(0.9) + 0.8, 1e-9);
  EXPECT_NEAR(log_class[1], std::log(0.6) + 0.8, 1e-9) << "a rider is most often called a person";
  EXPECT_NEAR(log_class[2], std::log(0.2) + 0.4, 1e-9);
  EXPECT_NEAR(log_class[3], std::log(0.5), 1e-9);
  EXPECT_NEAR(scan.measurements[0].log_clutter, std::log(0.5), 1e-9);
  EXPECT_TRUE(scanOf("", 0.9).measurements.at(0).log_class.empty());
}

TEST(VisionFrontEnd, ErrorsRepeatWhereTheIniSaysSo) {
  EXPECT_EQ(scanOf("", 0.9).model->lookMemory(), nullptr);
  const MeasurementScan scan =
      scanOf("memory_lasting = 0.3\nmemory_kept = 0.4\nmemory_time = 2\n", 0.9);
  const EvidenceMemory* memory = scan.model->lookMemory();
  ASSERT_TRUE(memory);
  EXPECT_EQ(memory->lasting, 0.3);
  EXPECT_EQ(memory->kept, 0.4);
  EXPECT_EQ(memory->time, 2);
}

TEST(VisionFrontEnd, EdgesThatRepeatCountAsOftenAsTheyAreNew) {
  EXPECT_EQ(scanOf("", 0.9).model->innovationShare(), 1);
  const double share = scanOf("memory_lasting = 0.3\n", 0.9).model->innovationShare();
  EXPECT_NEAR(share, 0.2 / 1.8, 1e-9);  // a correlation of 0.8 from image to image
}

/// Axes that are seen of a car at 20 m whose left part stands behind one at 12 m, by a detector
/// with these keys.
AxisMask axesBehindACar(const std::string& detector, double nearer_score) {
  const MeasurementScan scan = scanOf(
      "[class.car]\nmotion = wheeled\n[class.pedestrian]\nmotion = constant-velocity\n"
      "[sensor.A]\nkind = boxes\nmodality = C\n[sensor.A.detector]\nscore_slope = 2\n"
      "score_offset = 0.5\n" +
          detector,
      {detectionOf("Car", 0.9, boardBox(20, -1.1, -2, 1.5, kCameraPose)),
       detectionOf("Car", nearer_score, boardBox(12, 0.9, -0.7, 1.5, kCameraPose))});
  EXPECT_EQ(scan.measurements.at(1).seen, FootprintModel::kAll) << "nothing stands before it";
  return scan.measurements.at(0).seen;
}

TEST(VisionFrontEnd, AnEdgeAtANearerBoxIsThatOfTheNearerObject) {
  constexpr int kWithoutLeft = 1 << FootprintModel::kRight | 1 << FootprintModel::kRange;
  EXPECT_EQ(axesBehindACar("", 0.9), kWithoutLeft);
  EXPECT_EQ(axesBehindACar("amodal = true\n", 0.9), FootprintModel::kAll);
  EXPECT_EQ(axesBehindACar("", 0.3), FootprintModel::kAll) << "the nearer box is likelier clutter";
}

TEST(VisionFrontEnd, MapsNamesToLabelsAndDropsTheRest) {
  Config config = Config::fromText(
      "[class.car]\nmotion = wheeled\n[class.pedestrian]\nmotion = "
      "constant-velocity\n[sensor.A]\nkind = boxes\nmodality = C\n"
      "[sensor.A.detector]\nscore_slope = 2\nscore_offset = 0.5\nscore_offset.person = "
      "0.8\nmin_score = 0.1\n",
      "a.ini");
  const ClassTable classes = readClassTable(config);
  const auto front_end = makeVisionFrontEnd(config, "A", classes);
  EXPECT_NO_THROW(config.finish());
  SensorFrame frame;
  frame.sensor = "A";
  frame.T_ego_sensor = cameraPose(1.65);
  ObjectDetections detections;
  detections.camera = kCamera;
  for (const auto& [name, score] :
       {std::pair{"Car", 0.9}, {"Pedestrian", 0.9}, {"Giraffe", 0.9}, {"Car", 0.05}}) {
    ObjectDetection o;
    o.label = name;
    o.score = score;
    o.image_box = boardBox(12, 0.9, -0.7, 1.5, frame.T_ego_sensor);
    detections.objects.push_back(o);
  }
  frame.data = detections;
  const auto scan = front_end->extract(frame);
  ASSERT_EQ(scan.measurements.size(), 2u);
  EXPECT_NE(scan.measurements[0].label, scan.measurements[1].label);
  EXPECT_NEAR(scan.measurements[0].log_score_ratio, 2 * 0.4, 1e-12);
  EXPECT_NEAR(scan.measurements[1].log_score_ratio, 2 * 0.1, 1e-12);
}

}  // namespace
}  // namespace perception
