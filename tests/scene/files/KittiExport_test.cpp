#include "libperception/scene/files/KittiExport.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "libperception/core/Error.h"
#include "tests/scene/SceneFixture.h"

namespace perception {
namespace {

using namespace test;
using ImageBox = ObjectDetection::ImageBox;

// x right = -y left, y down = -z up, z forward = x forward.
Pose3 opticalAt(double x, double y, double z) {
  Pose3 pose = Pose3::Identity();
  pose.translation() = Vector3(x, y, z);
  pose.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return pose;
}

KittiCamera frontCamera() {
  KittiCamera camera;
  camera.camera = {1242, 375, 720, 720, 620, 175};
  camera.T_ego_camera = opticalAt(1, 0, 1.65);
  return camera;
}

Scene atOrigin(std::vector<SceneObject> objects) {
  Scene scene = someScene(4, std::move(objects));
  scene.ego.T_world_ego = Pose3::Identity();
  return scene;
}

SceneObject carAt(double x, double y, double yaw) {
  SceneObject car = someCar();
  car.position = {x, y, 0};
  car.yaw = yaw;
  car.existence = 0.5;
  return car;
}

std::optional<KittiObject> seen(const SceneObject& object) {
  return kittiObject(object, atOrigin({object}), pedestrianAndCar(), frontCamera());
}

/// A pedestrian-or-thing: class table of a pedestrian and of one that is not reported.
ClassTable pedestrianAndThing() {
  ClassTable table = pedestrianAndCar();
  table.classes[1].name = "static-other";
  table.classes[1].kitti_type = "Misc";
  table.classes[1].reported = false;
  return table;
}

TEST(KittiExport, AThingThatMayBeARoadUserIsWrittenAsSuchFromTheGivenProbabilityOn) {
  SceneObject o = carAt(21, 2, 0);
  o.existence = 0.8;
  o.class_id = 1;
  o.class_probability = {0.25, 0.75};
  const auto as = [&](double from) {
    return kittiObject(o, atOrigin({o}), pedestrianAndThing(), frontCamera(), {from, 0});
  };
  ASSERT_TRUE(as(0.5) && as(0.19));
  EXPECT_EQ(as(0.5)->type, "Misc");
  EXPECT_NEAR(as(0.5)->score, std::log(0.6 / 0.4), 1e-12);
  EXPECT_EQ(as(0.19)->type, "Pedestrian");
  EXPECT_NEAR(as(0.19)->score, std::log(0.2 / 0.8), 1e-12);
  EXPECT_EQ(as(0.21)->type, "Misc");
}

TEST(KittiExport, AnObjectWithoutHeadingIsAsBroadFromEverySide) {
  for (const double y : {0.0, 8.0}) {
    SceneObject o = carAt(21, y, 0);
    o.has_yaw = false;
    o.length = 4, o.width = 2;  // a disc of radius 1.5 m
    const auto line = seen(o);
    ASSERT_TRUE(line);
    const double bearing = std::atan2(-y, 20.0), half = std::asin(1.5 / std::hypot(20, y));
    EXPECT_NEAR(line->box.x1, 620 + 720 * std::tan(bearing - half), 1);
    EXPECT_NEAR(line->box.x2, 620 + 720 * std::tan(bearing + half), 1);
  }
}

TEST(KittiExport, ACarAheadIsWhereKittiSaysItIs) {
  const auto o = seen(carAt(21, 2, 0));
  ASSERT_TRUE(o);
  EXPECT_EQ(o->type, "Car");
  EXPECT_TRUE(o->bottom_center.isApprox(Vector3(-2, 1.65, 20), 1e-12));
  // Heading away from the camera along z: rotation_y = -pi/2.
  EXPECT_NEAR(o->rotation_y, -kPi / 2, 1e-12);
  EXPECT_NEAR(o->alpha, -kPi / 2 + std::atan2(2, 20), 1e-12);
  // The near face is 20 - 2.25 m away, 1.8 m wide, 1.5 m high.
  EXPECT_NEAR(o->box.x1, 620 + 720 * (-2.9 / 17.75), 1e-9);
  EXPECT_NEAR(o->box.y2, 175 + 720 * (1.65 / 17.75), 1e-9);
  EXPECT_NEAR(o->box.x2, 620 + 720 * (-1.1 / 22.25), 1e-9);
  EXPECT_NEAR(o->box.y1, 175 + 720 * (0.15 / 22.25), 1e-9);
  EXPECT_NEAR(o->score, 0, 1e-12);
}

TEST(KittiExport, WritesTheLineOfTheFormat) {
  SceneObject car = carAt(21, 2, kPi);
  car.id = 12;
  EXPECT_EQ(kittiLine(*seen(car)),
            "4 12 Car 0 0 1.670465 502.37 179.85 584.40 241.93 1.5000 1.8000 4.5000 -2.0000 1.6500 "
            "20.0000 1.570796 "
            "0.000000\n");
}

TEST(KittiExport, LeavesOutWhatLiesWhollyOutsideTheImage) {
  EXPECT_FALSE(seen(carAt(-20, 0, 0)));  // behind
  EXPECT_FALSE(seen(carAt(10, 40, 0)));  // far to the left
  EXPECT_FALSE(seen(carAt(10, -40, 1)));
  EXPECT_TRUE(seen(carAt(10, 9, 0)));  // partly in view
}

TEST(KittiExport, WritesWhatHasTheGivenShareOfItsBoxInTheImage) {
  // A square of 2 m, 2 m high, 18 to 20 m ahead of the camera, its near face across the left edge:
  // the image begins at 620 / 720 of the distance to the left.
  SceneObject o = carAt(20, 0, 0);
  o.length = o.width = 2, o.height = 2;
  const double left = 620.0 / 720 * 18;
  const auto in_image = [&](double y, double share) {
    o.position.y() = y;
    return kittiObject(o, atOrigin({o}), pedestrianAndCar(), frontCamera(), {0.5, share})
        .has_value();
  };
  // Seen from the near left corner to the far right one, the box is as wide as these two lie apart.
  const auto share = [&](double y) {
    const double x1 = 620 - 720 * (y + 1) / 18, x2 = 620 - 720 * (y - 1) / 20;
    return x2 / (x2 - x1);
  };
  for (const double y : {left - 0.5, left, left + 0.5}) {
    EXPECT_TRUE(in_image(y, share(y) - 0.01)) << y;
    EXPECT_FALSE(in_image(y, share(y) + 0.01)) << y;
    EXPECT_TRUE(in_image(y, 0)) << y;
  }
}

TEST(KittiExport, CutsABoxAtTheCameraAndAtTheImage) {
  const auto o =
      seen(carAt(2, 1.5, 0));  // from 1.25 m behind the camera to 3.25 m before it, at its left
  ASSERT_TRUE(o);
  EXPECT_EQ(o->box.x1, 0);
  EXPECT_EQ(o->box.y2, 374);
  EXPECT_NEAR(o->box.x2, 620 - 720 * (0.6 / 3.25), 1e-9);
  for (const double v : {o->box.x1, o->box.y1, o->box.x2, o->box.y2}) EXPECT_TRUE(std::isfinite(v));
}

TEST(KittiExport, TurningTheWorldChangesNothing) {
  const SceneObject car = carAt(15, -3, 0.7);
  const auto before = seen(car);
  const Pose3 T_world_ego = makePose(500, -80, 3, 2.2);
  SceneObject moved = car;
  moved.position = T_world_ego * car.position;
  moved.yaw = wrapAngle(car.yaw + 2.2);
  Scene scene = atOrigin({moved});
  scene.ego.T_world_ego = T_world_ego;
  const auto after = kittiObject(moved, scene, pedestrianAndCar(), frontCamera());
  ASSERT_TRUE(before && after);
  EXPECT_TRUE(before->bottom_center.isApprox(after->bottom_center, 1e-10));
  EXPECT_NEAR(before->rotation_y, after->rotation_y, 1e-10);
  EXPECT_NEAR(before->box.x1, after->box.x1, 1e-7);
  EXPECT_NEAR(before->box.y2, after->box.y2, 1e-7);
}

TEST(KittiExport, TheOffsetOfCameraZeroMovesTheBoxInSpaceButNotInTheImage) {
  const SceneObject car = carAt(15, -3, 0.7);
  KittiCamera camera = frontCamera();
  camera.reference_in_camera = KittiCamera::kittiOffset();
  const auto own = seen(car),
             reference = kittiObject(car, atOrigin({car}), pedestrianAndCar(), camera);
  ASSERT_TRUE(own && reference);
  EXPECT_TRUE(
      (own->bottom_center - reference->bottom_center).isApprox(KittiCamera::kittiOffset(), 1e-9));
  EXPECT_NEAR(own->box.x1, reference->box.x1, 1e-9);
}

TEST(KittiExport, AScoreGrowsWithExistenceAndStaysFinite) {
  double last = -1e9;
  for (const double existence : {0.0, 0.1, 0.5, 0.9, 0.999, 1.0}) {
    SceneObject car = carAt(20, 0, 0);
    car.existence = existence;
    const double score = seen(car)->score;
    EXPECT_GT(score, last);
    EXPECT_LT(std::abs(score), 14);
    last = score;
  }
}

TEST(KittiExport, WritesScenesWithAFrameNumberOnly) {
  const TemporaryFolder folder;
  KittiExport out(folder / "kitti.txt", pedestrianAndCar(), frontCamera());
  Scene scene = atOrigin({carAt(20, 0, 0), carAt(-20, 0, 0), carAt(30, 1, 2)});
  out.write(scene);
  scene.frame = -1;
  out.write(scene);
  out.close();
  const std::string text = readText(folder / "kitti.txt");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
}

// A label of KITTI's tracking benchmark with the calibration of its sequence.
struct Label {
  std::int64_t frame;
  std::string type;
  double truncated;
  int occluded;
  double alpha;
  ImageBox box;
  double h, w, l, x, y, z, ry;
};

std::vector<Label> readLabels(const std::string& path) {
  std::istringstream in(readText(path));
  std::vector<Label> labels;
  Label o;
  int id;
  while (in >> o.frame >> id >> o.type >> o.truncated >> o.occluded >> o.alpha >> o.box.x1 >>
         o.box.y1 >> o.box.x2 >> o.box.y2 >> o.h >> o.w >> o.l >> o.x >> o.y >> o.z >> o.ry) {
    if (o.type != "DontCare") labels.push_back(o);
  }
  return labels;
}

std::map<std::string, std::vector<double>> readCalibration(const std::string& path) {
  std::istringstream in(readText(path));
  std::map<std::string, std::vector<double>> matrices;
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    std::string name;
    fields >> name;
    for (double v; fields >> v;) matrices[name].push_back(v);
  }
  return matrices;
}

// Camera 2 on the ego frame, which lies 1.73 m below the velodyne.
KittiCamera cameraOf(const std::map<std::string, std::vector<double>>& calibration) {
  const auto& p2 = calibration.at("P2:");
  const auto& r = calibration.at("R0_rect:");
  const auto& tr = calibration.at("Tr_velo_to_cam:");
  Pose3 T_reference_velodyne = Pose3::Identity();
  Eigen::Matrix3d rectify, rotation;
  rectify << r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8];
  rotation << tr[0], tr[1], tr[2], tr[4], tr[5], tr[6], tr[8], tr[9], tr[10];
  T_reference_velodyne.linear() = rectify * rotation;
  T_reference_velodyne.translation() = rectify * Vector3(tr[3], tr[7], tr[11]);
  KittiCamera camera;
  camera.camera = {1242, 375, p2[0], p2[5], p2[2], p2[6]};
  camera.reference_in_camera = {(p2[3] - p2[2] * p2[11]) / p2[0], (p2[7] - p2[6] * p2[11]) / p2[5],
                                p2[11]};
  const Pose3 T_reference_camera = Pose3(Eigen::Translation3d(-camera.reference_in_camera));
  camera.T_ego_camera =
      makePose(0, 0, 1.73, 0) * T_reference_velodyne.inverse() * T_reference_camera;
  return camera;
}

double overlap(const ImageBox& a, const ImageBox& b) {
  const double w = std::min(a.x2, b.x2) - std::max(a.x1, b.x1),
               h = std::min(a.y2, b.y2) - std::max(a.y1, b.y1);
  const double both = std::max(w, 0.0) * std::max(h, 0.0);
  return both / ((a.x2 - a.x1) * (a.y2 - a.y1) + (b.x2 - b.x1) * (b.y2 - b.y1) - both);
}

TEST(KittiExport, RealLabelsComeBackFromTheWorldAsTheyWere) {
  const std::string data = std::string(PERCEPTION_SHARED_DATA) + "/data/kitti_tracking/";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "no recordings of KITTI's tracking benchmark";
  std::size_t labels = 0;
  double worst_position = 0, worst_rotation = 0, worst_alpha = 0, worst_overlap = 1;
  for (const std::string sequence : {"0000", "0001", "0010", "0013"}) {
    const KittiCamera camera = cameraOf(readCalibration(data + "calib/" + sequence + ".txt"));
    const Pose3 T_world_ego = makePose(-30, 12, 0.5, 1.1);
    const Pose3 T_world_reference =
        T_world_ego * camera.T_ego_camera * Eigen::Translation3d(camera.reference_in_camera);
    for (const Label& label : readLabels(data + "label_02/" + sequence + ".txt")) {
      Scene scene;
      scene.frame = label.frame;
      scene.ego.T_world_ego = T_world_ego;
      SceneObject object = someCar();
      const Vector3 place(label.x, label.y, label.z);
      object.position = T_world_reference * place;
      const Vector3 front =
          T_world_reference.linear() * Vector3(std::cos(label.ry), 0, -std::sin(label.ry));
      object.yaw = std::atan2(front.y(), front.x());
      object.length = label.l, object.width = label.w, object.height = label.h;
      const auto o = kittiObject(object, scene, pedestrianAndCar(), camera);
      if (!o) continue;
      ++labels;
      worst_position = std::max(worst_position, (o->bottom_center - place).norm());
      worst_rotation = std::max(worst_rotation, std::abs(wrapAngle(o->rotation_y - label.ry)));
      // Nearer, KITTI's alpha depends on where on the vehicle one stands.
      if (label.z > 10)
        worst_alpha = std::max(worst_alpha, std::abs(wrapAngle(o->alpha - label.alpha)));
      // People's image boxes were drawn about their limbs by hand; all others are projections.
      if (label.truncated == 0 && label.type != "Pedestrian") {
        worst_overlap = std::min(worst_overlap, overlap(o->box, label.box));
      }
    }
  }
  EXPECT_GT(labels, 5000u);
  EXPECT_LT(worst_position, 1e-5);  // the calibration's rotations have seven digits
  EXPECT_LT(worst_rotation,
            2e-3);  // the camera is not level: turns about its and the world's axis differ slightly
  EXPECT_LT(worst_alpha, 0.03);
  EXPECT_GT(worst_overlap, 0.9);
}

}  // namespace
}  // namespace perception
