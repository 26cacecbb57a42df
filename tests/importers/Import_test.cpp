#include <gtest/gtest.h>
#include <mrpt/obs/CObservationImage.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <opencv2/imgcodecs.hpp>

#include "libperception/importers/kitti/KittiLabels.h"
#include "libperception/sensors/observations/CObservationObjectDetections.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

/// A calibration with ideal axes: the camera stands in the Velodyne, looks along its x and has no
/// rotation but that.
constexpr const char* kCalibration =
    "P2: 700 0 600 42 0 700 180 0 0 0 1 0\n"
    "R0_rect: 1 0 0 0 1 0 0 0 1\n"
    "Tr_velo_to_cam: 0 -1 0 0 0 0 -1 0 1 0 0 0\n"
    "Tr_imu_to_velo: 1 0 0 -0.8 0 1 0 0.3 0 0 1 -0.8\n";
constexpr const char* kPoses =
    "1 0 0 0 0 1 0 0 0 0 1 0\n"
    "1 0 0 1 0 1 0 0 0 0 1 0\n"
    "0 -1 0 2 1 0 0 0 0 0 1 0\n"
    "0 -1 0 2 1 0 0 1 0 0 1 0\n";
/// A car of 4 x 2 x 1.5 m that stands 10 m ahead of frame 0 on the ground (camera y = 1.73).
constexpr const char* kLabels =
    "0 -1 DontCare -1 -1 -10 1 2 3 4 -1000 -1000 -1000 -10 -1 -1 -1\n"
    "0 5 Car 0 1 -1.57 550 150 650 220 1.5 2 4 0 1.73 10 -1.5707963\n"
    "1 5 Car 1 0 -1.57 550 150 650 220 1.5 2 4 0 1.73 9 -1.5707963\n"
    "2 7 Tram 0 2 0 550 150 650 220 3 2.5 12 5 1.73 20 0\n";

class ImportTest : public test::ImportRun {
 protected:
  ImportTest() {
    write("calib.txt", kCalibration);
    write("poses.txt", kPoses);
    write("labels.txt", kLabels);
  }

  /// Runs `perception-import kitti` with calibration, poses, output and more; gives the exit code.
  int import(std::vector<std::string> more = {}, const std::string& poses = "poses.txt") {
    more.insert(more.end(), {"--calib", file("calib.txt")});
    if (!poses.empty()) more.insert(more.end(), {"--poses", file(poses)});
    return ImportRun::import("kitti", more);
  }
  std::vector<Pose3> egoPoses() const {
    EgoPose ego;
    std::vector<Pose3> poses;
    for (const auto& o : readLog()) {
      ego.add(*o);
      if (frameNumber(*o)) poses.push_back(ego.at(ego.latest())->T_world_ego);
    }
    return poses;
  }
};

TEST_F(ImportTest, WorldIsTheEgoFrameOfTheFirstPose) {
  ASSERT_EQ(import(), 0) << error_;
  const auto poses = egoPoses();
  ASSERT_EQ(poses.size(), 4U);
  EXPECT_TRUE(poses[0].isApprox(Pose3::Identity(), 1e-9));
  EXPECT_TRUE(poses[3].isApprox(makePose(2, 1, 0, kPi / 2), 1e-9));
}

TEST_F(ImportTest, PosesOfCameraAndTumGiveTheSameMotion) {
  // The same motion seen from the camera: T_cam0_camk = A T_velo0_velok A^-1.
  Pose3 A = Pose3::Identity();
  A.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  std::string camera, tum = "# t x y z qx qy qz qw\n";
  for (const Pose3& velo : readKittiPoses(file("poses.txt"), "kitti")) {
    const Pose3 cam = A * velo * A.inverse();
    for (int i = 0; i < 12; ++i)
      camera += std::to_string(cam.matrix()(i / 4, i % 4)) + (i == 11 ? "\n" : " ");
    const Eigen::Quaterniond q(velo.linear());
    tum += "0";
    for (const double v : {velo.translation().x(), velo.translation().y(), velo.translation().z(),
                           q.x(), q.y(), q.z(), q.w()}) {
      tum += " " + std::to_string(v);
    }
    tum += "\n";
  }
  write("camera.txt", camera);
  write("tum.txt", tum);
  ASSERT_EQ(import({"--poses-frame", "camera"}, "camera.txt"), 0) << error_;
  EXPECT_TRUE(egoPoses()[3].isApprox(makePose(2, 1, 0, kPi / 2), 1e-5));
  ASSERT_EQ(import({"--poses-format", "tum"}, "tum.txt"), 0) << error_;
  EXPECT_TRUE(egoPoses()[3].isApprox(makePose(2, 1, 0, kPi / 2), 1e-5));
}

TEST_F(ImportTest, OxtsGivesMetersAndHeading) {
  // A tenth of an arc second of latitude is 3.09 m of Mercator plane scaled by cos(latitude),
  // whatever the latitude.
  write("oxts.txt", "49 8.4 110 0 0 1.5707963268 0 0\n49.000027778 8.4 110 0 0 1.5707963268 0 0\n");
  ASSERT_EQ(import({"--oxts", file("oxts.txt")}, ""), 0) << error_;
  const auto poses = egoPoses();
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_NEAR(poses[1].translation().x(), 6378137 * radians(0.1 / 3600),
              1e-3);  // northward is ahead
  EXPECT_NEAR(poses[1].translation().y(), 0, 1e-3);
}

TEST_F(ImportTest, FrameNumbersAndStampsSurviveFirstAndLast) {
  ASSERT_EQ(import({"--first", "1", "--last", "2", "--rate", "8", "--labels", file("labels.txt")}),
            0)
      << error_;
  std::vector<std::int64_t> numbers;
  std::vector<Stamp> stamps;
  for (const auto& o : readLog()) {
    if (const auto n = frameNumber(*o)) {
      numbers.push_back(*n);
      stamps.push_back(Stamp::fromSeconds(mrpt::Clock::toDouble(o->timestamp)));
    }
  }
  EXPECT_EQ(numbers, (std::vector<std::int64_t>{1, 2}));
  EXPECT_NEAR(stamps[1] - stamps[0], 0.125, 1e-6);
  const auto truth = readGroundTruth(file("out.truth.csv"));
  ASSERT_EQ(truth.instants.size(), 2U);
  EXPECT_EQ(truth.instants[0].frame, 1);
  EXPECT_EQ(truth.instants[0].t, 0);
  EXPECT_NEAR(truth.instants[1].t, 0.125, 1e-9);
}

TEST_F(ImportTest, WithoutPosesTheFilesSayWhichFramesThereAre) {
  for (const char* name : {"velo/000001.bin", "velo/000002.bin", "velo/readme.txt"})
    write(name, bytesOf<float>({8.1F, 0, -1, 0.5F}));
  ASSERT_EQ(import({"--lidar", file("velo"), "--first", "1"}, ""), 0) << error_;
  EXPECT_EQ(result_.scans, 2);
  for (const auto& o : readLog()) EXPECT_NE(o->sensorLabel, "EGO_POSE");
  ASSERT_FALSE(result_.notes.empty());
  EXPECT_NE(result_.notes[0].find("source = lidar"), std::string::npos) << result_.notes[0];
  EXPECT_EQ(import({"--lidar", file("velo"), "--labels", file("labels.txt")}, ""), 64);
  EXPECT_NE(error_.find("--labels needs --poses"), std::string::npos) << error_;
}

TEST_F(ImportTest, TruthStandsInTheWorld) {
  ASSERT_EQ(import({"--labels", file("labels.txt")}), 0) << error_;
  const auto truth = readGroundTruth(file("out.truth.csv"));
  ASSERT_EQ(truth.instants.size(), 3U);
  const TruthObject& area = truth.instants[0].objects[0];
  EXPECT_TRUE(area.ignore);
  EXPECT_TRUE(std::isnan(area.position.x()));
  for (int k = 0; k < 2; ++k) {  // the parked car, from two places
    const auto& objects = truth.instants[static_cast<std::size_t>(k)].objects;
    const TruthObject& car = objects.back();
    EXPECT_EQ(car.id, 5);
    EXPECT_TRUE(car.position.isApprox(Vector3(10, 0, 0), 1e-6)) << car.position.transpose();
    EXPECT_NEAR(std::abs(wrapAxis(car.yaw)), 0, 1e-5);
    EXPECT_EQ(car.length, 4);
    EXPECT_EQ(car.width, 2);
    EXPECT_EQ(car.height, 1.5);
    EXPECT_NEAR(car.vx, 0, 1e-5);
    EXPECT_EQ(car.lidar_points, -1);
    EXPECT_FALSE(car.ignore);
  }
  EXPECT_NEAR(truth.instants[1].objects[0].truncated, 1, 1e-9);
  const TruthObject& tram = truth.instants[2].objects[0];
  EXPECT_TRUE(tram.ignore);
  EXPECT_EQ(tram.occluded, 2);
  // 20 m ahead and 5 m to the right of a vehicle that stands at (2, 0) and looks along y.
  EXPECT_TRUE(tram.position.isApprox(Vector3(7, 20, 0), 1e-5)) << tram.position.transpose();
  EXPECT_TRUE(std::isnan(tram.vx));
}

TEST_F(ImportTest, ReturnsInsideTheBoxAreCounted) {
  const std::vector<float> points = {
      8.1F,  0, -1,    0.5F, 11.9F, 0.9F, -0.3F, 0.5F,   // inside
      12.1F, 0, -1,    0.5F, 10,    1.1F, -1,    0.5F,   // beside
      10,    0, -1.8F, 0.5F, 10,    0,    -0.1F, 0.5F};  // below and above
  const std::string bytes(reinterpret_cast<const char*>(points.data()),
                          points.size() * sizeof(float));
  write("velo/000000.bin", bytes);
  const gzFile gz = gzopen(file("velo/000001.bin.gz").c_str(), "wb");
  gzwrite(gz, bytes.data(), static_cast<unsigned>(bytes.size()));
  gzclose(gz);
  ASSERT_EQ(import({"--labels", file("labels.txt"), "--lidar", file("velo"), "--last", "1"}), 0)
      << error_;
  EXPECT_EQ(result_.scans, 2);
  EXPECT_EQ(result_.points, 12U);
  const auto truth = readGroundTruth(file("out.truth.csv"));
  EXPECT_EQ(truth.instants[0].objects[1].lidar_points, 2);
  EXPECT_EQ(truth.instants[0].objects[0].lidar_points, -1);
  for (const auto& o : readLog()) {
    if (o->sensorLabel != "LIDAR_TOP") continue;
    const auto frame = frameFromObservation(*o);
    ASSERT_TRUE(frame);
    EXPECT_NEAR(frame->T_ego_sensor.translation().z(), 1.73, 1e-9);
    EXPECT_EQ(std::get<LidarCloud>(frame->data).x[0], 8.1F);
  }
}

TEST_F(ImportTest, DetectionsOfOneNameMergeAndEmptyFramesAreSaid) {
  write("car.txt", "0,10,20,30,40,0.5\n2,11,21,31,41,0.25\n");
  write("ped.txt", "0,50,60,70,80,0.75\n");
  write("rcnn.txt", "1,2,10,20,110,90,3.5,1.5,2,4,0,1.73,10,-1.5707963,0.25\n");
  write("dpm.txt", "3 -1 Car -1 -1 1.96 343 181 400 212 -1 -1 -1 -1000 -1000 -1000 -10 2.43\n");
  ASSERT_EQ(
      import({"--detections", "rrc:Car=" + file("car.txt"), "--detections",
              "rrc:Pedestrian=" + file("ped.txt"), "--detections",
              "pointrcnn:Car=" + file("rcnn.txt"), "--detections", "dpm:Car=" + file("dpm.txt")}),
      0)
      << error_;
  EXPECT_EQ(result_.detections,
            (std::map<std::string, std::uint64_t>{{"dpm", 1}, {"pointrcnn", 1}, {"rrc", 3}}));
  std::map<std::string, std::vector<ObjectDetections>> by_sensor;
  std::map<std::string, Pose3> sensor_poses;
  for (const auto& o : readLog()) {
    if (const auto frame = frameFromObservation(*o)) {
      by_sensor[frame->sensor].push_back(std::get<ObjectDetections>(frame->data));
      sensor_poses[frame->sensor] = frame->T_ego_sensor;
    }
  }
  ASSERT_EQ(by_sensor["rrc"].size(), 4U);  // one observation a frame, also without a detection
  ASSERT_EQ(by_sensor["rrc"][0].objects.size(), 2U);
  EXPECT_EQ(by_sensor["rrc"][0].objects[1].label, "Pedestrian");
  EXPECT_EQ(by_sensor["rrc"][1].objects.size(), 0U);
  EXPECT_EQ(by_sensor["rrc"][2].objects[0].score, 0.25);
  EXPECT_FALSE(by_sensor["rrc"][2].objects[0].heading);
  EXPECT_EQ(by_sensor["dpm"][3].objects[0].heading, 1.96);
  const auto& box = by_sensor["pointrcnn"][1].objects[0];
  ASSERT_TRUE(box.space_box);
  EXPECT_TRUE(box.space_box->bottom_center.isApprox(Vector3(10, 0, -1.73), 1e-9));
  EXPECT_NEAR(wrapAxis(box.space_box->yaw), 0, 1e-6);
  EXPECT_EQ(box.heading, 0.25);
  EXPECT_TRUE(sensor_poses["pointrcnn"].isApprox(makePose(0, 0, 1.73, 0), 1e-9));
  // The camera's optical frame: z ahead, x to the right; P2's fourth column puts it 42 / 700 m to
  // the left.
  const Pose3& camera = sensor_poses["rrc"];
  EXPECT_TRUE((camera * Vector3(0, 0, 1)).isApprox(Vector3(1, 0.06, 1.73), 1e-9));
  EXPECT_TRUE((camera * Vector3(1, 0, 0)).isApprox(Vector3(0, -0.94, 1.73), 1e-9));
  EXPECT_TRUE(by_sensor["pointrcnn"][1].T_ego_camera->isApprox(camera, 1e-9));
}

TEST_F(ImportTest, ObservationAnglesNeedNotBeWrappedAndMinusTenIsNone) {
  const std::string rest = " 10 20 110 90 1.5 2 4 0 1.73 10 -7.8539816 3.5\n";
  write("mine.txt",
        "0 Car -1 -1 -9.25" + rest + "1 Car -1 -1 -10" + rest + "2 Car -1 -1 -1000" + rest);
  ASSERT_EQ(import({"--detections", "kitti3d-mine:Car=" + file("mine.txt")}), 0) << error_;
  std::vector<ObjectDetection> found;
  for (const auto& o : readLog()) {
    if (o->sensorLabel != "kitti3d-mine") continue;
    const auto frame = frameFromObservation(*o);
    for (const auto& d : std::get<ObjectDetections>(frame->data).objects) found.push_back(d);
  }
  ASSERT_EQ(found.size(), 3U);
  ASSERT_TRUE(found[0].heading);
  EXPECT_NEAR(*found[0].heading, 4 * kPi / 2 - 9.25, 1e-9);
  EXPECT_NEAR(wrapAxis(found[0].space_box->yaw), 0, 1e-6);
  EXPECT_FALSE(found[1].heading);
  EXPECT_FALSE(found[2].heading);
}

TEST_F(ImportTest, BoxesInSpaceAreReadInTwoLayouts) {
  write("mine.txt",
        "0 Car -1 -1 0 10 20 110 90 1.5 2 4 0 1.73 10 0 3.5\n"
        "0,2,10,20,110,90,2.5,1.5,2,4,0,1.73,20,0,0\n");
  ASSERT_EQ(import({"--detections", "boxes3d:Car=" + file("mine.txt")}), 0) << error_;
  std::vector<double> scores;
  for (const auto& o : readLog()) {
    if (o->sensorLabel != "boxes3d") continue;
    const auto frame = frameFromObservation(*o);
    for (const auto& d : std::get<ObjectDetections>(frame->data).objects) scores.push_back(d.score);
  }
  EXPECT_EQ(scores, (std::vector<double>{3.5, 2.5}));
  write("short.txt", "0 Car -1 -1\n");
  EXPECT_NE(import({"--detections", "boxes3d:Car=" + file("short.txt")}), 0);
  EXPECT_NE(error_.find("15 (frame"), std::string::npos) << error_;
}

TEST_F(ImportTest, NuscenesBoxesStandInTheFrameOfThePoses) {
  const std::string box =
      R"({"translation": [X, 1, 2], "size": [1.8, 4.5, 1.5], "rotation": [1, 0, 0, 0],
          "detection_name": "car", "detection_score": 0.75, "velocity": [1, 0]})";
  const auto at = [&](const std::string& x) { return std::string(box).replace(17, 1, x); };
  write("mine.json", "{\"meta\": {\"use_lidar\": true},\n\"results\": {\"0\": [" + at("20") +
                         "], \"000002\": [" + at("30") + "]}}");
  ASSERT_EQ(import({"--detections", "boxes3d:Car=" + file("mine.json")}), 0) << error_;
  std::vector<ObjectDetection> found;
  std::vector<std::size_t> counts;
  for (const auto& o : readLog()) {
    if (o->sensorLabel != "boxes3d") continue;
    const auto frame = frameFromObservation(*o);
    const auto& objects = std::get<ObjectDetections>(frame->data).objects;
    counts.push_back(objects.size());
    found.insert(found.end(), objects.begin(), objects.end());
  }
  ASSERT_EQ(counts, (std::vector<std::size_t>{1, 0, 1, 0}));
  const std::vector<Pose3> poses = readKittiPoses(file("poses.txt"), "kitti");
  const std::size_t frames[] = {0, 2};
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(found[i].label, "Car");
    EXPECT_EQ(found[i].score, 0.75);
    EXPECT_EQ(found[i].space_box->length, 4.5);
    EXPECT_EQ(found[i].space_box->width, 1.8);
    const Vector3 bottom(i == 0 ? 20 : 30, 1, 2 - 0.75);
    EXPECT_TRUE((poses[frames[i]] * found[i].space_box->bottom_center).isApprox(bottom, 1e-6));
  }
}

TEST_F(ImportTest, ALogOfBoxesInSpaceIsExportedAsKittisImageBoxes) {
  std::string boxes, poses;
  for (int k = 0; k < 30; ++k) {
    boxes += std::to_string(k) + " Car -1 -1 -10 0 0 0 0 1.5 1.8 4.2 2 1.73 20 1.57 9\n";
    poses += "1 0 0 0 0 1 0 0 0 0 1 0\n";
  }
  write("mine.txt", boxes);
  write("standing.txt", poses);
  ASSERT_EQ(import({"--detections", "boxes3d:Car=" + file("mine.txt")}, "standing.txt"), 0)
      << error_;
  TrackApp app;
  const int code = runQuietly(
      app, {"perception-track", "-c", std::string(PERCEPTION_SOURCE_DIR) + "/ini/any-detector.ini",
            "-i", file("out.rawlog"), "-o", file("run"), "--export", "kitti:" + file("result.txt"),
            "--threads", "1"});
  EXPECT_TRUE(code == 0 || code == 3) << error_;
  const auto lines = readKittiLabels(file("result.txt"));
  ASSERT_FALSE(lines.empty());
  const KittiLabel& last = lines.back();
  EXPECT_EQ(last.frame, 29);
  EXPECT_EQ(last.type, "Car");
  ASSERT_TRUE(last.box);
  EXPECT_TRUE(last.box->bottom_center.isApprox(Vector3(2, 1.73, 20), 0.05));
  // The box of 1.5 m at 18 to 22 m, in the image of P2 = 700 px.
  EXPECT_NEAR(last.image_box.y2 - last.image_box.y1, 700 * 1.5 / 18, 10);
}

TEST_F(ImportTest, NuscenesFaultsNameTheLineAndWhatWasExpected) {
  const std::vector<std::pair<std::string, std::string>> faults = {
      {"{\"results\":\n{\"ca9a28\": []}}", "mine.json:2: sample 'ca9a28': expected the number"},
      {"{\"results\":\n\n{\"1\": [{\"translation\": [1, 2]}]}}",
       "mine.json:3: translation: expected 3 numbers"},
      {"{\"results\":\n{\"1\": 7}}", "mine.json:2: a sample: expected a list of boxes"},
      {"{\"results\":\n{\"1\": [", "mine.json:2: not JSON"},
      {"{\"boxes\": {}}", "no member 'results'"},
  };
  for (const auto& [text, message] : faults) {
    write("mine.json", text);
    EXPECT_EQ(import({"--detections", "boxes3d:Car=" + file("mine.json")}), 65);
    EXPECT_NE(error_.find(message), std::string::npos) << error_;
  }
}

TEST_F(ImportTest, ImagesAreEmbeddedOrStandBesideTheLog) {
  const cv::Mat gray(400, 600, CV_8UC3, cv::Scalar(10, 20, 30));
  fs::create_directories(folder_ / "images");
  for (int k = 0; k < 4; ++k) cv::imwrite(file("images/00000" + std::to_string(k) + ".png"), gray);
  for (const bool embedded : {false, true}) {
    std::vector<std::string> more = {"--images", file("images")};
    if (embedded) more.push_back("--embed-images");
    ASSERT_EQ(import(more), 0) << error_;
    EXPECT_EQ(result_.images, 4);
    EXPECT_LT(result_.bytes_inflated, 4 * 400 * 600U);  // JPEG, not three bytes a pixel
    for (const auto& o : readLog()) {
      const auto image = std::dynamic_pointer_cast<mrpt::obs::CObservationImage>(o);
      if (!image) continue;
      EXPECT_EQ(image->cameraParams.ncols, 600U);
      EXPECT_EQ(image->cameraParams.fx(), 700);
      EXPECT_EQ(image->image.isExternallyStored(), !embedded);
      if (embedded) {
        EXPECT_EQ(image->image.getWidth(), 600U);
      } else {
        EXPECT_TRUE(
            fs::exists(fs::path(folder_ / "out_Images") / image->image.getExternalStorageFile()));
      }
    }
  }
}

TEST_F(ImportTest, FaultsNameFileAndLineAndLeaveNoOutput) {
  const auto expectFault = [this](int code, const std::string& text, std::vector<std::string> more,
                                  const std::string& poses = "poses.txt") {
    EXPECT_EQ(import(std::move(more), poses), code) << error_;
    EXPECT_NE(error_.find(text), std::string::npos) << error_;
    EXPECT_FALSE(fs::exists(file("out.rawlog")));
    EXPECT_FALSE(fs::exists(file("out.truth.csv")));
  };
  write("bad_poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 x 0 1 0 0 0 0 1 0\n");
  expectFault(65, "bad_poses.txt:2: field 4: found 'x', expected a number", {}, "bad_poses.txt");
  write("short_poses.txt", "1 0 0 0 0 1 0 0 0 0 1\n");
  expectFault(65, "short_poses.txt:1: 11 fields", {}, "short_poses.txt");
  write("skewed.txt", "1 0 0 0 0 2 0 0 0 0 1 0\n");
  expectFault(65, "skewed.txt:1: the 3x3 part is no rotation", {}, "skewed.txt");
  expectFault(66, "none.txt", {}, "none.txt");
  expectFault(65, "4 poses (frames 0 to 3)", {"--last", "9"});
  write("bad_labels.txt", std::string(kLabels) + "3 7 Car 0\n");
  expectFault(65, "bad_labels.txt:5: 4 fields", {"--labels", file("bad_labels.txt")});
  expectFault(66, "nowhere", {"--lidar", file("nowhere")});
  write("velo/000000.bin", "12345");
  expectFault(65, "000000.bin: 5 bytes", {"--lidar", file("velo")});
  fs::create_directories(folder_ / "no_scans");
  expectFault(66, "no scan for 4 of 4 frames", {"--lidar", file("no_scans")});
  expectFault(64, "unknown detector 'yolo'", {"--detections", "yolo:Car=" + file("labels.txt")});
  expectFault(64, "expected NAME:CLASS=FILE", {"--detections", "rrc=" + file("labels.txt")});
  write("rcnn.txt", "1,9,10,20,110,90,3.5,1.5,2,4,0,1.73,10,-1.57,0.25\n");
  expectFault(65, "rcnn.txt:1: field 2: found '9'",
              {"--detections", "pointrcnn:Car=" + file("rcnn.txt")});
  expectFault(64, "--poses or --oxts", {}, "");
  EXPECT_EQ(import({"--rate", "-1"}), 64);
}

TEST_F(ImportTest, MissingScansAreOneWarning) {
  write("velo/000000.bin", std::string(32, '\0'));
  EXPECT_EQ(import({"--lidar", file("velo")}), 3);
  EXPECT_NE(error_.find("no scan for 3 of 4 frames (first: 1)"), std::string::npos) << error_;
  EXPECT_TRUE(fs::exists(file("out.rawlog")));
}

TEST_F(ImportTest, TheSameInputGivesTheSameBytes) {
  const auto bytes = [this] {
    std::ifstream log(file("out.rawlog"), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(log), {});
  };
  ASSERT_EQ(import({"--labels", file("labels.txt")}), 0);
  const std::string first = bytes();
  ASSERT_EQ(import({"--labels", file("labels.txt")}), 0);
  EXPECT_EQ(first, bytes());
}

}  // namespace
}  // namespace perception
