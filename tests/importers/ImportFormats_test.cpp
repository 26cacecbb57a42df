#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "libperception/core/GroundTruth.h"
#include "libperception/importers/street_sets/VodFiles.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

/// The camera stands in the lidar, looks along its x and has no rotation but that.
constexpr const char* kVodCalibration =
    "P2: 700 0 600 0 0 700 180 0 0 0 1 0\n"
    "R0_rect: 1 0 0 0 1 0 0 0 1\n"
    "Tr_velo_to_cam: 0 -1 0 0 0 0 -1 0 1 0 0 0\n";

std::string textOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Found by a fuzzer.
TEST(VodFiles, AnEmptyRadarFileIsAScanWithoutPoints) {
  const test::TemporaryFolder folder;
  const std::string path = folder.path() + "/00001.bin";
  std::ofstream(path, std::ios::binary).flush();
  EXPECT_TRUE(readVodRadar(path).empty());
}

TEST(Importers, EachHasANameOfItsOwnAndSaysWhatItReads) {
  std::set<std::string> names;
  for (const ImporterRow& row : importers()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_GT(std::string(row.description).size(), 20u) << row.name;
    EXPECT_NE(row.make(), nullptr);
  }
  EXPECT_EQ(names.size(), 23u);
}

class ImportOptionsOfFormats : public test::ImportRun {};

TEST_F(ImportOptionsOfFormats, AnUnknownFormatIsToldWhichThereAre) {
  for (const char* line : {"rosbag: no such format; there are:", " wads", " clouds"})
    expectFault(64, line, "rosbag", {});
}

TEST_F(ImportOptionsOfFormats, WhatAFormatCannotUseIsRefused) {
  expectFault(64, "--rate", "udacity", {"--measurements", file("u.txt"), "--rate", "5"});
  expectFault(64, "--repeat", "clouds", {"--clouds", file("c"), "--repeat", "5"});
  expectFault(64, "--copy-images", "nmea", {"--track", file("a.nmea"), "--copy-images"});
}

// ------------------------------------------------------------- WADS, SnowyKITTI: snow per point

class SnowImport : public test::ImportRun {
 protected:
  void SetUp() override {
    for (const char* stem : {"000007", "000008"}) {
      writeGz(std::string("set/velodyne/") + stem + ".bin.gz",
              bytesOf<float>({5, 0, -2, 51, 6, 1, 0, 255}));
      writeGz(std::string("set/labels/") + stem + ".label.gz",
              bytesOf<std::uint32_t>({40, 110 + (3U << 16)}));
    }
  }
};

TEST_F(SnowImport, ScansGoIntoTheLogAndLabelsBesideIt) {
  write("set/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1.3 0 1 0 0 0 0 1 0\n");
  ASSERT_EQ(import("wads", {"--dir", file("set")}), 0) << error_;
  const auto frames = framesOf("LIDAR_TOP");
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_NEAR(frames[1].stamp - frames[0].stamp, 0.1, 1e-6);
  EXPECT_NEAR(frames[1].ego.T_world_ego.translation().x(), 1.3, 1e-9);
  EXPECT_NEAR(frames[0].T_ego_sensor.translation().z(), 2.17, 1e-9);
  const auto& cloud = std::get<LidarCloud>(frames[0].data);
  EXPECT_NEAR(cloud.intensity[0], 0.2, 1e-6);
  EXPECT_TRUE(cloud.label.empty());  // a sensor would not know it
  EXPECT_EQ(frameNumbers(), (std::vector<std::int64_t>{7, 8}));
  for (const char* stem : {"000007", "000008"}) {
    EXPECT_EQ(textOf(file(std::string("out_Labels/") + stem + ".label.gz")),
              textOf(file(std::string("set/labels/") + stem + ".label.gz")));
  }
  const auto& notes = result_.notes;
  EXPECT_NE(std::find(notes.begin(), notes.end(), "label 110 (falling snow): 2 points"),
            notes.end());
}

TEST_F(SnowImport, WithoutPosesTheMotionIsNotKnown) {
  ASSERT_EQ(import("snowykitti", {"--dir", file("set"), "--lidar-height", "1.8"}), 0) << error_;
  EXPECT_EQ(result_.poses, 0);
  EXPECT_EQ(result_.scans, 2);
}

TEST_F(SnowImport, NoFrameIsAnErrorThatNamesTheFramesThereAre) {
  expectFault(66, "no frame is within --first 0 --last 2: the recording has the frames 7 to 8",
              "wads", {"--dir", file("set"), "--last", "2"});
  expectFault(66, "no frame is within --first 9: the recording has the frames 7 to 8", "wads",
              {"--dir", file("set"), "--first", "9"});
}

TEST_F(SnowImport, FaultsNameTheFile) {
  expectFault(66, "velodyne: no such folder", "wads", {"--dir", file("nowhere")});
  write("set/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  expectFault(65, "poses.txt: 1 poses, expected one for each of 2 scans", "wads",
              {"--dir", file("set")});
  fs::remove(file("set/poses.txt"));
  writeGz("set/labels/000008.label.gz", bytesOf<std::uint32_t>({40}));
  expectFault(65, "000008.label.gz: 4 bytes, expected 4 (uint32) for each of the 2 points", "wads",
              {"--dir", file("set")});
  fs::remove(file("set/labels/000008.label.gz"));
  EXPECT_EQ(import("wads", {"--dir", file("set")}), 3);
  EXPECT_NE(error_.find("no labels for 1 of 2 frames (first: 8)"), std::string::npos) << error_;
}

// ------------------------------------------------------------------------------- View of Delft

/// A frame: a car ahead with one lidar point, two radar points of what stands, one of a car that
/// moves with 1 m/s; the vehicle drives 5 m/s.
class VodImport : public test::ImportRun {
 protected:
  void SetUp() override {
    addFrame("00005");
    addFrame("00900");
  }
  void addFrame(const std::string& stem) const {
    write("vod/lidar_points/" + stem + ".bin", bytesOf<float>({10, 0, -1, 255}));
    const float diagonal = 5 / std::sqrt(2.0F);
    write("vod/radar_points/" + stem + ".bin",
          bytesOf<float>(
              {10, 0, 0, 7, -4, 1, 0, 0, 10, 0, 5, 0, 0, 0, 10, 10, 0, 5, -diagonal, 0, 0}));
    write("vod/calib_lidar/" + stem + ".txt", kVodCalibration);
    // The radar 2 m ahead of the lidar and 1 m below it.
    write("vod/calib_radar/" + stem + ".txt",
          "P2: 700 0 600 0 0 700 180 0 0 0 1 0\nR0_rect: 1 0 0 0 1 0 0 0 1\n"
          "Tr_velo_to_cam: 0 -1 0 0 0 0 -1 1 1 0 0 2\n");
    write("vod/pose/" + stem + ".json",
          "{\"odomToCamera\": [0, 0, 1, 3, -1, 0, 0, 4, 0, -1, 0, 1, 0, 0, 0, 1]}\n"
          "{\"mapToCamera\": []}\n");
    write("vod/label_2/" + stem + ".txt",
          "Car 0 1 0 500 100 700 250 1.5 2 4 0 1.65 10 -1.5707963 1\n"
          "rider 1 0 0 500 100 700 250 1.5 1 1 2 1.65 12 0 1\n");
  }
  std::vector<std::string> dir() const { return {"--dir", file("vod")}; }
};

TEST_F(VodImport, RadarStandsWhereItIsAndGivesRatesAgainstTheMovingVehicle) {
  ASSERT_EQ(import("vod", dir()), 0) << error_;
  const auto frames = framesOf("RADAR_FRONT");
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_NEAR(frames[1].stamp - frames[0].stamp, 89.5, 1e-6);
  EXPECT_TRUE(frames[0].T_ego_sensor.isApprox(makePose(2, 0, 0.65, 0), 1e-9));
  const auto& returns = std::get<RadarReturns>(frames[0].data).returns;
  ASSERT_EQ(returns.size(), 3u);
  EXPECT_NEAR(returns[0].range, 10, 1e-6);
  EXPECT_EQ(returns[0].range_rate, -4);
  EXPECT_EQ(returns[0].amplitude, 7);
  EXPECT_NEAR(returns[1].bearing, kPi / 2, 1e-6);
  // A frame alone gets its velocity from the difference of the radar's two rates.
  EXPECT_NEAR(frames[0].ego.velocity.x(), 5, 1e-4);
  EXPECT_NEAR(frames[0].ego.velocity.y(), 0, 1e-4);
}

TEST_F(VodImport, LabelsAreTruthInTheWorld) {
  ASSERT_EQ(import("vod", dir()), 0) << error_;
  const auto truth = readGroundTruth(file("out.truth.csv"));
  ASSERT_EQ(truth.instants.size(), 2u);
  const TruthObject& car = truth.instants[0].objects[0];
  EXPECT_EQ(car.frame, 5);
  EXPECT_TRUE(car.position.isApprox(Vector3(10, 0, 0), 1e-4)) << car.position.transpose();
  EXPECT_NEAR(car.yaw, 0, 1e-5);
  EXPECT_EQ(car.length, 4);
  EXPECT_EQ(car.lidar_points, 1);
  EXPECT_EQ(car.occluded, 1);
  EXPECT_FALSE(car.ignore);
  EXPECT_TRUE(truth.instants[0].objects[1].ignore);
  EXPECT_NE(truth.instants[1].objects[0].id, car.id);  // the labels carry no identities
}

TEST_F(VodImport, RepeatedFramesShowAStillWorld) {
  ASSERT_EQ(import("vod", {"--dir", file("vod"), "--repeat", "4"}), 0) << error_;
  const auto frames = framesOf("RADAR_FRONT");
  ASSERT_EQ(frames.size(), 8u);
  EXPECT_LT(frames[3].stamp - frames[0].stamp, 0.05);  // too short for anything to move
  EXPECT_NEAR(frames[1].ego.velocity.norm(), 0, 1e-6);
  // Rates over ground, since the vehicle stands.
  EXPECT_EQ(std::get<RadarReturns>(frames[0].data).returns[0].range_rate, 1);
  EXPECT_EQ(frameNumbers(), (std::vector<std::int64_t>{5, 900}));
  EXPECT_EQ(readGroundTruth(file("out.truth.csv")).instants.size(), 2u);
}

TEST_F(VodImport, TheWholeDataSetsFoldersAreKnown) {
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"lidar_points", "lidar/training/velodyne"},
                                                        {"radar_points", "radar/training/velodyne"},
                                                        {"calib_lidar", "lidar/training/calib"},
                                                        {"calib_radar", "radar/training/calib"},
                                                        {"label_2", "lidar/training/label_2"},
                                                        {"pose", "lidar/training/pose"}}) {
    fs::create_directories(fs::path(file("whole/" + to)).parent_path());
    fs::rename(file("vod/" + from), file("whole/" + to));
  }
  ASSERT_EQ(import("vod", {"--dir", file("whole"), "--first", "900"}), 0) << error_;
  EXPECT_EQ(result_.scans, 1);
  EXPECT_EQ(result_.radar_scans, 1);
  EXPECT_EQ(result_.truth_rows, 2u);
}

TEST_F(VodImport, FaultsNameTheFile) {
  expectFault(66, "nowhere: no such folder", "vod", {"--dir", file("nowhere")});
  fs::create_directories(file("empty"));
  expectFault(66, "expected a View-of-Delft folder", "vod", {"--dir", file("empty")});
  write("vod/radar_points/00005.bin", "12345");
  expectFault(65, "00005.bin: 5 bytes, expected 28 a point", "vod", dir());
  addFrame("00005");
  write("vod/pose/00005.json", "{\"odomToCamera\": [1, 2]}\n");
  expectFault(65, "00005.json: no odomToCamera of 16 numbers", "vod", dir());
  addFrame("00005");
  write("vod/label_2/00005.txt", "Car 0 1 0\n");
  expectFault(65, "00005.txt:1: 4 fields", "vod", dir());
  addFrame("00005");
  fs::remove(file("vod/calib_radar/00900.txt"));
  expectFault(66, "no calib_radar/00900.txt", "vod", dir());
  addFrame("00900");
  fs::remove(file("vod/radar_points/00900.bin"));
  EXPECT_EQ(import("vod", dir()), 3);
  EXPECT_NE(error_.find("no radar scan for 1 of 2 frames (first: 900)"), std::string::npos)
      << error_;
}

// ------------------------------------------------------------------------------------- RADIATE

/// Two radar pictures with one echo 100 pixels ahead, two scans of a point ahead, GPS on the way
/// east, one car annotated ahead and one to the left.
class RadiateImport : public test::ImportRun {
 protected:
  void SetUp() override {
    fs::create_directories(file("r/Navtech_Cartesian"));
    cv::Mat picture = cv::Mat::zeros(400, 400, CV_8UC1);
    for (int v = 99; v <= 101; ++v) {
      for (int u = 197; u <= 203; ++u) picture.at<std::uint8_t>(v, u) = 180;
    }
    picture.at<std::uint8_t>(100, 200) = 200;
    picture.at<std::uint8_t>(300, 200) = 40;  // too weak
    cv::imwrite(file("r/Navtech_Cartesian/000001.png"), picture);
    cv::imwrite(file("r/Navtech_Cartesian/000002.png"), picture);
    write("r/Navtech_Cartesian.txt",
          "Frame: 000001 Time: 1000.200000000\nFrame: 000002 Time: 1000.450000000\n");
    write("r/velo_lidar/000008.csv", "1,10,-2,255,3\n");
    write("r/velo_lidar/000009.csv", "1,10,-2,255,3\n");
    write("r/velo_lidar.txt", "Frame: 000008 Time: 1000.0\nFrame: 000009 Time: 1000.100000000\n");
    write("r/calib.yaml",
          "lidar_calib:\n  T: [0.5, -0.1, 0.25]\n  R: [0, 0, 0]\nleft_cam_calib:\n"
          "  T: [0.3, 0, 0.3]\n  R: [0, 0, 0]\n  fx: 338\n  fy: 338\n  cx: 341\n  cy: 200\n"
          "  k1: -0.18\n  k2: 0.03\n  k3: 0\n  p1: 0\n  p2: 0\n");
    write("r/annotations.json",
          "[{\"id\": 3, \"class_name\": \"car\", \"bboxes\": [{\"position\": [195, 90, 10, 20], "
          "\"rotation\": 90}, []]}, {\"id\": 4, \"class_name\": \"group_of_pedestrians\", "
          "\"bboxes\": [[], {\"position\": [95, 190, 10, 20], \"rotation\": 0}]}]");
    std::string gps = "frame,lat_deg,lon_deg,alt_m\n", times;
    for (int i = 0; i < 12; ++i) {  // every 0.1 s 1e-5 deg east at the equator: 11.1 m/s
      gps += std::to_string(i) + ",0," + std::to_string(i * 1e-5) + ",5\n";
      times += "Frame: " + std::to_string(i) + " Time: " + std::to_string(999.5 + 0.1 * i) + "\n";
    }
    write("r/gps.csv", gps);
    write("r/GPS_IMU_Twist.txt", times);
  }
  std::vector<std::string> dir() const { return {"--dir", file("r"), "--gps-shift", "0"}; }
};

TEST_F(RadiateImport, EchoesStandForTheirSurroundings) {
  ASSERT_EQ(import("radiate", dir()), 0) << error_;
  const auto frames = framesOf("RADAR_TOP");
  ASSERT_EQ(frames.size(), 2u);
  const auto& returns = std::get<RadarReturns>(frames[0].data).returns;
  ASSERT_EQ(returns.size(), 1u);
  EXPECT_NEAR(returns[0].range, 100 * 0.17361, 1e-6);
  EXPECT_EQ(returns[0].bearing, 0);
  EXPECT_FALSE(returns[0].has_rate);
  EXPECT_EQ(returns[0].amplitude, 200);
  // The stamps are 0.2 s late.
  EXPECT_EQ(frames[0].stamp.ns, 1'000'000'000'000);
  EXPECT_EQ(frameNumbers(), (std::vector<std::int64_t>{1, 2}));
  EXPECT_NEAR(frames[0].T_ego_sensor.translation().z(), 1.8, 1e-9);
}

TEST_F(RadiateImport, LidarLooksAheadAndGpsMovesTheVehicle) {
  ASSERT_EQ(import("radiate", dir()), 0) << error_;
  const auto frames = framesOf("LIDAR_TOP");
  ASSERT_EQ(frames.size(), 2u);
  // The file's x looks to the right and its y ahead; the lidar hangs 0.1 m behind and 0.5 m right
  // of the radar.
  EXPECT_TRUE(
      (frames[0].T_ego_sensor * Vector3(1, 10, -2)).isApprox(Vector3(9.9, -1.5, 0.05), 1e-6));
  EXPECT_NEAR(frames[0].ego.velocity.norm(), 11.1, 0.1);
  EXPECT_NEAR(yawOf(frames[0].ego.T_world_ego), 0, 1e-6);  // east
}

TEST_F(RadiateImport, AnnotationsAreTruth) {
  ASSERT_EQ(import("radiate", dir()), 0) << error_;
  const auto truth = readGroundTruth(file("out.truth.csv"));
  ASSERT_EQ(truth.instants.size(), 2u);
  const TruthObject& car = truth.instants[0].objects[0];
  EXPECT_EQ(car.type, "Car");
  EXPECT_EQ(car.id, 3);
  const double ego = 5 * 1e-5 * kPi / 180 * 6378137;  // [m] east of the first fix
  EXPECT_NEAR(car.position.x() - ego, 100 * 0.17361, 1e-2);
  EXPECT_NEAR(car.position.y(), 0, 1e-2);
  EXPECT_NEAR(car.yaw, kPi / 2, 1e-6);
  EXPECT_NEAR(car.length, 20 * 0.17361, 1e-4);
  EXPECT_TRUE(std::isnan(car.height));
  const TruthObject& group = truth.instants[1].objects[0];
  EXPECT_TRUE(group.ignore);  // no class of ours
  EXPECT_NEAR(group.position.y(), 100 * 0.17361, 1e-2);
}

TEST_F(RadiateImport, ImagesAreLinkedCopiedOrEmbedded) {
  fs::create_directories(file("r/zed_left"));
  cv::imwrite(file("r/zed_left/000001.png"), cv::Mat(20, 30, CV_8UC3, cv::Scalar(1, 2, 3)));
  write("r/zed_left.txt", "Frame: 1 Time: 1000.05\n");
  for (const std::string how : {"", "--copy-images", "--embed-images"}) {
    fs::remove_all(file("out_Images"));
    auto words = dir();
    if (!how.empty()) words.push_back(how);
    ASSERT_EQ(import("radiate", words), 0) << error_;
    EXPECT_EQ(result_.images, 1);
    for (const auto& o : readLog()) {
      const auto image = std::dynamic_pointer_cast<mrpt::obs::CObservationImage>(o);
      if (!image) continue;
      EXPECT_EQ(image->sensorLabel, "CAMERA_LEFT");
      EXPECT_EQ(image->cameraParams.dist[0], -0.18);
      EXPECT_EQ(image->image.isExternallyStored(), how != "--embed-images");
      if (how == "--embed-images") continue;
      const std::string name = image->image.getExternalStorageFile();
      EXPECT_EQ(name, how.empty() ? "CAMERA_LEFT/000001.png" : "CAMERA_LEFT_000001.png");
      EXPECT_TRUE(fs::exists(file("out_Images/" + name)));
    }
    EXPECT_EQ(fs::is_symlink(file("out_Images/CAMERA_LEFT")), how.empty());
  }
}

TEST_F(RadiateImport, FaultsNameTheFile) {
  expectFault(66, "nowhere: no such folder", "radiate", {"--dir", file("nowhere")});
  write("r/annotations.json", "[{\"id\": 1}]");
  expectFault(65, "annotations.json: object 0: expected id, class_name", "radiate", dir());
  write("r/annotations.json", "[{\"id\": 1, \"class_name\": \"car\", \"bboxes\": [{}]}]");
  expectFault(65, "object 0, box 0: expected position", "radiate", dir());
  write("r/annotations.json", "{");
  expectFault(65, "no JSON list", "radiate", dir());
  SetUp();
  write("r/Navtech_Cartesian.txt", "Frame: 000001 Time: soon\n");
  expectFault(65, "Navtech_Cartesian.txt:1: field 4: found 'soon'", "radiate", dir());
  SetUp();
  write("r/velo_lidar/000008.csv", "1,10\n");
  expectFault(65, "000008.csv:1: 2 fields", "radiate", dir());
  SetUp();
  write("r/Navtech_Cartesian/000002.png", "no picture");
  expectFault(65, "000002.png: not an image", "radiate", dir());
  SetUp();
  write("r/calib.yaml", "lidar_calib: 5\n");
  expectFault(65, "calib.yaml: expected lidar_calib", "radiate", dir());
  fs::remove(file("r/calib.yaml"));
  expectFault(66, "calib.yaml: no such file", "radiate", dir());
  SetUp();
  // Two scans of one point do not tell the shift of the GPS clock: said, and begun at once.
  EXPECT_EQ(import("radiate", {"--dir", file("r")}), 3);
  EXPECT_NE(error_.find("its clock is not synchronized"), std::string::npos) << error_;
}

// ----------------------------------------------------------------------------------- comma2k19

/// At latitude and longitude 0, on the way north with 10 m/s; what stands 50 m ahead closes at it.
class Comma2k19Import : public test::ImportRun {
 protected:
  void SetUp() override {
    std::string poses = "t_s,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,q0,q1,q2,q3\n";
    std::string speeds = "t_s,speed_mps\n", gyro = "t_s,forward,right,down\n";
    std::string gnss = "t_s,lat_deg,lon_deg,speed_mps,utc_ms,altitude_m,bearing_deg\n";
    for (int i = 0; i < 20; ++i) {
      const std::string t = std::to_string(500 + 0.1 * i);
      // Columns forward (north, z), right (east, y), down (-x) of the rotation.
      poses += t + ",6378137,0," + std::to_string(i * 1.0) + ",0,0,10,0.70710678,0,-0.70710678,0\n";
      speeds += t + ",10\n";
      gyro += t + ",0.01,0.02,-0.03\n";
      gnss += t + ",0,0,10," + std::to_string(1600000000000LL + 100 * i) + ",0,0\n";
    }
    write("c/pose_20hz_ecef.csv", poses);
    write("c/ego_speed.csv", speeds);
    write("c/gyro.csv", gyro);
    write("c/gnss_ublox_10hz.csv", gnss);
    write("c/radar_tracks.csv",
          "t_s,forward_m,left_m,rel_speed_mps,can_address,new_track\n"
          "501.000,30,40,-10,528,0\n501.001,20,0,2,530,1\n501.050,29.5,40,-10,528,0\n");
  }
  std::vector<std::string> dir() const {
    return {"--dir", file("c"), "--device-yaw", "0", "--device-up", "0", "--radar-delay", "0"};
  }
};

TEST_F(Comma2k19Import, SlotsOfOneMomentAreOneScan) {
  ASSERT_EQ(import("comma2k19", dir()), 0) << error_;
  const auto frames = framesOf("RADAR_FRONT");
  ASSERT_EQ(frames.size(), 2u);
  const auto& returns = std::get<RadarReturns>(frames[0].data).returns;
  ASSERT_EQ(returns.size(), 2u);
  EXPECT_NEAR(returns[0].range, 50, 1e-9);
  EXPECT_NEAR(returns[0].bearing, std::atan2(40, 30), 1e-9);
  EXPECT_EQ(returns[0].range_rate, -10);
  EXPECT_EQ(returns[1].id, 2);
  EXPECT_EQ(frames[0].stamp.ns, 1'600'000'001'001'000'000);  // the receiver's UTC
}

TEST_F(Comma2k19Import, TheDevicesPoseBecomesTheVehiclesOnTheRoad) {
  ASSERT_EQ(import("comma2k19", dir()), 0) << error_;
  const auto frames = framesOf("RADAR_FRONT");
  const Pose3& ego = frames[0].ego.T_world_ego;
  EXPECT_NEAR(yawOf(ego), kPi / 2, 1e-6);  // north, in a world of east, north, up
  EXPECT_NEAR(ego.translation().x(), 0, 1e-6);
  EXPECT_NEAR(ego.translation().y(), 10.01, 1e-3);
  EXPECT_NEAR(ego.translation().z(), 0, 1e-6);
  EXPECT_NEAR(frames[0].ego.velocity.y(), 10, 1e-3);
  EXPECT_TRUE(frames[0].T_ego_sensor.isApprox(makePose(1.52, 0, 0.5, 0), 1e-9));
}

TEST_F(Comma2k19Import, GnssGyroAndOdometryStandBeside) {
  ASSERT_EQ(import("comma2k19", dir()), 0) << error_;
  std::set<std::string> seen;
  for (const auto& o : readLog()) {
    if (const auto imu = std::dynamic_pointer_cast<mrpt::obs::CObservationIMU>(o)) {
      EXPECT_EQ(imu->get(mrpt::obs::IMU_WX), 0.01);
      EXPECT_EQ(imu->get(mrpt::obs::IMU_WY), -0.02);
      EXPECT_EQ(imu->get(mrpt::obs::IMU_WZ), 0.03);
      seen.insert("imu");
    } else if (const auto odo = std::dynamic_pointer_cast<mrpt::obs::CObservationOdometry>(o)) {
      EXPECT_EQ(odo->velocityLocal.vx, 10);
      EXPECT_NEAR(odo->velocityLocal.omega, 0.03, 1e-9);
      seen.insert("odometry");
    } else if (std::dynamic_pointer_cast<mrpt::obs::CObservationGPS>(o)) {
      seen.insert("gps");
    }
  }
  EXPECT_EQ(seen.size(), 3u);
}

TEST_F(Comma2k19Import, FaultsNameFileLineAndColumn) {
  expectFault(66, "nowhere", "comma2k19", {"--dir", file("nowhere")});
  fs::remove(file("c/gyro.csv"));
  expectFault(66, "gyro.csv", "comma2k19", dir());
  SetUp();
  write("c/radar_tracks.csv", "t_s,forward_m,left_m,can_address,new_track\n");
  expectFault(65, "radar_tracks.csv", "comma2k19", dir());
  write("c/radar_tracks.csv",
        "t_s,forward_m,left_m,rel_speed_mps,can_address,new_track\n501,far,0,0,528,0\n");
  expectFault(65, "radar_tracks.csv:2: column 'forward_m': found 'far'", "comma2k19", dir());
  SetUp();
  write("c/pose_20hz_ecef.csv",
        "t_s,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps,q0,q1,q2,q3\n501,6378137,0,0,0,0,0,1,1,0,0\n");
  expectFault(65, "pose_20hz_ecef.csv:2: q0 to q3: no unit quaternion", "comma2k19", dir());
}

// ------------------------------------------------------------------------------------- Udacity

class UdacityImport : public test::ImportRun {};

TEST_F(UdacityImport, LinesBecomePositionsAndReturnsWithTheirTruth) {
  write("u.txt",
        "L\t1.5\t2.5\t1477010443000000\t1\t2\t3\t4\n"
        "R\t5\t0.5\t-1\t1477010443050000\t1.1\t2.1\t3\t4\t0.9\t0.1\n");
  ASSERT_EQ(import("udacity", {"--measurements", file("u.txt")}), 0) << error_;
  const auto laser = framesOf("LASER"), radar = framesOf("RADAR");
  ASSERT_EQ(laser.size(), 1u);
  ASSERT_EQ(radar.size(), 1u);
  EXPECT_EQ(laser[0].stamp.ns, 1'477'010'443'000'000'000);
  const auto& box = *std::get<ObjectDetections>(laser[0].data).objects.at(0).space_box;
  EXPECT_TRUE(box.bottom_center.isApprox(Vector3(1.5, 2.5, 0), 1e-9));
  const RadarReturn& r = std::get<RadarReturns>(radar[0].data).returns.at(0);
  EXPECT_EQ(r.range, 5);
  EXPECT_EQ(r.bearing, 0.5);
  EXPECT_EQ(r.range_rate, -1);
  const auto truth = readGroundTruth(file("out.truth.csv"));
  ASSERT_EQ(truth.instants.size(), 2u);
  EXPECT_EQ(truth.instants[0].objects[0].vx, 3);
  EXPECT_NEAR(truth.instants[0].objects[0].yaw, std::atan2(4, 3), 1e-6);
  EXPECT_NEAR(truth.instants[1].objects[0].yaw, 0.9, 1e-6);
  EXPECT_NEAR(truth.instants[1].t, 0.05, 1e-6);
}

TEST_F(UdacityImport, FaultsNameTheLine) {
  const auto expect = [&](const std::string& text, const std::string& message) {
    write("u.txt", text);
    expectFault(65, message, "udacity", {"--measurements", file("u.txt")});
  };
  expect("L 1 2 1477010443000000 1 2 3 4\nS 1 2 3\n", "u.txt:2: field 1: found 'S', expected L");
  expect("L 1 2 1477010443000000 1 2 3\n", "u.txt:1: 7 fields, expected 8 or 10");
  expect("R 1 2 3 1477010443.5 1 2 3 4\n", "u.txt:1: field 5: found '1477010443.5'");
  expect("\n", "no line in it");
  expectFault(66, "none.txt", "udacity", {"--measurements", file("none.txt")});
}

// ------------------------------------------------------- single images of the object benchmark

class ImagesImport : public test::ImportRun {
 protected:
  void SetUp() override {
    fs::create_directories(file("o/image_2"));
    for (const char* stem : {"000003", "000009"}) {
      const std::string name = stem;
      cv::imwrite(file("o/image_2/" + name + ".png"), cv::Mat(40, 60, CV_8UC3, cv::Scalar(9)));
      write("o/calib/" + name + ".txt", kVodCalibration);
      write("o/label_2/" + name + ".txt",
            "Car 0.2 0 -1.57 10 5 50 30 1.5 2 4 0 1.73 10 -1.5707963\n"
            "DontCare -1 -1 -10 1 2 3 4 -1 -1 -1 -1000 -1000 -1000 -10\n");
    }
  }
};

TEST_F(ImagesImport, FramesThatStandAloneShareNoObject) {
  ASSERT_EQ(import("images", {"--dir", file("o"), "--label-boxes", "--repeat", "3"}), 0) << error_;
  const auto frames = framesOf("LABELLED_BOXES");
  ASSERT_EQ(frames.size(), 6u);
  EXPECT_NEAR(frames[3].stamp - frames[0].stamp, 10, 1e-6);
  EXPECT_NEAR(
      (frames[3].ego.T_world_ego.translation() - frames[0].ego.T_world_ego.translation()).norm(),
      500, 1e-6);
  for (const auto& frame : frames) EXPECT_NEAR(frame.ego.velocity.norm(), 0, 1e-6);
  const auto& objects = std::get<ObjectDetections>(frames[0].data).objects;
  ASSERT_EQ(objects.size(), 1u);  // areas are no objects
  EXPECT_EQ(objects[0].label, "Car");
  EXPECT_EQ(objects[0].image_box->x2, 50);
  const auto truth = readGroundTruth(file("out.truth.csv"));
  ASSERT_EQ(truth.instants.size(), 2u);
  const TruthObject& car = truth.instants[1].objects[0];
  EXPECT_TRUE(car.position.isApprox(Vector3(510, 0, 0), 1e-6)) << car.position.transpose();
  EXPECT_NEAR(car.truncated, 0.2, 1e-9);
  EXPECT_EQ(result_.images, 2);
  EXPECT_EQ(frameNumbers(), (std::vector<std::int64_t>{3, 9}));
}

TEST_F(ImagesImport, WithARateTheyAreASequence) {
  write("o/velodyne/000003.bin", bytesOf<float>({10, 0, -1, 0.5F}));
  write("o/velodyne/000009.bin", bytesOf<float>({10, 0, -1, 0.5F}));
  ASSERT_EQ(import("images", {"--dir", file("o"), "--rate", "5"}), 0) << error_;
  const auto frames = framesOf("LIDAR_TOP");
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_NEAR(frames[1].stamp - frames[0].stamp, 0.2, 1e-6);
  EXPECT_TRUE(frames[1].ego.T_world_ego.isApprox(Pose3::Identity(), 1e-9));
  EXPECT_EQ(readGroundTruth(file("out.truth.csv")).instants[0].objects[0].lidar_points, 1);
}

TEST_F(ImagesImport, FaultsNameTheFile) {
  expectFault(66, "image_2: no such folder", "images", {"--dir", file("nowhere")});
  expectFault(64, "--repeat is too large for --rate", "images",
              {"--dir", file("o"), "--rate", "100", "--repeat", "5"});
  write("o/label_2/000009.txt", "Car 0 0\n");
  expectFault(65, "000009.txt:1: 3 fields", "images", {"--dir", file("o")});
  fs::remove(file("o/label_2/000009.txt"));
  EXPECT_EQ(import("images", {"--dir", file("o")}), 3);
  EXPECT_NE(error_.find("no labels for 1 of 2 frames (first: 9)"), std::string::npos) << error_;
  fs::remove(file("out.rawlog"));
  fs::remove(file("out.truth.csv"));
  write("o/image_2/000009.png", "no picture");
  expectFault(65, "000009.png: not an image", "images", {"--dir", file("o")});
  fs::remove(file("o/calib/000003.txt"));
  expectFault(66, "calib/000003.txt: no calibration", "images", {"--dir", file("o")});
}

TEST_F(ImagesImport, ScansCanBeTheFramesAndImagesMayBeMissing) {
  fs::remove_all(file("o/image_2"));
  write("o/velodyne/000003.bin", bytesOf<float>({10, 0, -1, 0.5F, 30, 0, -1, 0.5F}));
  writeGz("o/velodyne/000009.bin.gz", bytesOf<float>({10, 0, -1, 0.5F}));
  ASSERT_EQ(import("kitti-object", {"--dir", file("o"), "--repeat", "3"}), 0) << error_;
  EXPECT_EQ(result_.images, 0);
  EXPECT_EQ(result_.points, 9u);
  const auto frames = framesOf("LIDAR_TOP");
  ASSERT_EQ(frames.size(), 6u);
  EXPECT_NEAR(frames[3].stamp - frames[0].stamp, 10, 1e-6);
  EXPECT_NEAR(
      (frames[3].ego.T_world_ego.translation() - frames[0].ego.T_world_ego.translation()).norm(),
      500, 1e-6);
  for (const auto& frame : frames) EXPECT_NEAR(frame.ego.velocity.norm(), 0, 1e-6);
  EXPECT_EQ(frameNumbers(), (std::vector<std::int64_t>{3, 9}));
  const auto truth = readGroundTruth(file("out.truth.csv"));
  ASSERT_EQ(truth.instants.size(), 2u);
  ASSERT_EQ(truth.instants[0].objects.size(), 2u);
  EXPECT_EQ(truth.instants[0].objects[0].lidar_points, 1);
  EXPECT_TRUE(truth.instants[0].objects[1].ignore);
  EXPECT_EQ(truth.instants[0].objects[1].type, "DontCare");
}

TEST_F(ImagesImport, FaultsOfScansNameTheFile) {
  expectFault(66, "velodyne: no such folder", "kitti-object", {"--dir", file("o")});
  write("o/velodyne/000003.bin", bytesOf<float>({10, 0, -1, 0.5F}));
  write("o/velodyne/000009.bin", "17 bytes, no more");
  expectFault(65, "000009.bin: 17 bytes, expected 16 a point", "kitti-object",
              {"--dir", file("o")});
  write("o/velodyne/000009.bin", bytesOf<float>({10, 0, -1, 0.5F}));
  write("o/label_2/000009.txt", "\nCar 0.2 0 -1.57 10 5 50 30 1.5 2 4 0 1.73 far -1.57\n");
  expectFault(65, "000009.txt:2: field 14: found 'far', expected a number", "kitti-object",
              {"--dir", file("o")});
  fs::remove(file("o/calib/000003.txt"));
  expectFault(66, "calib/000003.txt: no calibration", "kitti-object", {"--dir", file("o")});
}

// ----------------------------------------------------------------------------- receivers' tracks

class TrackImport : public test::ImportRun {};

constexpr const char* kGga =
    "$GPGGA,120000,0000.000,N,00000.000,E,1,08,0.9,0,M,0,M,,\n"
    "$GPGGA,120001,0000.010,N,00000.000,E,1,08,0.9,0,M,0,M,,\n"
    "$GPGGA,120002,0000.010,N,00000.010,E,1,08,0.9,0,M,0,M,,\n";

TEST_F(TrackImport, AReceiversWayIsTheVehicles) {
  write("a.nmea", kGga);
  ASSERT_EQ(import("nmea", {"--track", file("a.nmea"), "--date", "2020-02-03"}), 0) << error_;
  EXPECT_EQ(result_.poses, 3);
  EXPECT_EQ(result_.others.at("GPS"), 3u);
  EgoPose ego;
  std::vector<Stamp> stamps;
  for (const auto& o : readLog()) {
    ego.add(*o);
    if (const auto gps = std::dynamic_pointer_cast<mrpt::obs::CObservationGPS>(o))
      stamps.push_back(Stamp::fromSeconds(mrpt::Clock::toDouble(gps->timestamp)));
  }
  ASSERT_EQ(stamps.size(), 3u);
  EXPECT_NEAR(stamps[0].seconds(), 1580731200, 1e-3);  // 2020-02-03 12:00:00 UTC
  const double minute = 6378137 * kPi / 180 / 60;      // [m] of the equator
  const auto end = ego.at(stamps[2]);
  ASSERT_TRUE(end);
  EXPECT_NEAR(end->T_world_ego.translation().x(), 0.01 * minute, 0.01);
  EXPECT_NEAR(yawOf(ego.at(stamps[0])->T_world_ego), kPi / 2, 0.01);  // north
}

// 33 m/s, a fix a second, 13 km.
TEST_F(TrackImport, AFastReceiverIsOneObjectAllTheWay) {
  std::string gpx = "<gpx><trk><trkseg>";
  for (int k = 0; k < 400; ++k)
    gpx +=
        fmt::format("<trkpt lat='{:.7f}' lon='0'><time>2020-02-03T12:{:02d}:{:02d}Z</time></trkpt>",
                    k * 33 / 110574.0, k / 60, k % 60);
  write("a.gpx", gpx + "</trkseg></trk></gpx>");
  ASSERT_EQ(import("gpx", {"--track", file("a.gpx"), "--as-object"}), 0) << error_;
  const auto scenes = track("gps_object.ini", "L");
  ASSERT_EQ(scenes.size(), 400u);
  std::set<std::uint64_t> ids;
  for (const Scene& scene : scenes) {
    for (const SceneObject& object : scene.objects) ids.insert(object.id);
  }
  EXPECT_EQ(ids.size(), 1u);
  EXPECT_NEAR(scenes.back().objects.at(0).velocity.norm(), 33, 0.5);
}

TEST_F(TrackImport, AReceiverOnAnObjectIsMeasured) {
  write("a.gpx",
        "<gpx><trk><trkseg>"
        "<trkpt lat='0' lon='0'><time>2020-02-03T12:00:00Z</time></trkpt>"
        "<trkpt lat='0.0001' lon='0'><time>2020-02-03T12:00:01Z</time></trkpt>"
        "</trkseg></trk></gpx>");
  ASSERT_EQ(import("gpx", {"--track", file("a.gpx"), "--as-object"}), 0) << error_;
  const auto frames = framesOf("GPS_OBJECT");
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_NEAR(frames[1].stamp.seconds(), 1580731201, 1e-3);
  EXPECT_TRUE(frames[1].ego.T_world_ego.isApprox(Pose3::Identity(), 1e-9));
  const auto& box = *std::get<ObjectDetections>(frames[1].data).objects.at(0).space_box;
  EXPECT_NEAR(box.bottom_center.x(), 0, 1e-6);
  EXPECT_NEAR(box.bottom_center.y(), 11.06, 0.01);  // a minute of arc north is 1843 m there
}

TEST_F(TrackImport, FaultsNameTheFile) {
  expectFault(66, "none.nmea", "nmea", {"--track", file("none.nmea")});
  write("a.nmea", "hello\n");
  expectFault(65, "a.nmea: no NMEA sentence", "nmea", {"--track", file("a.nmea")});
  write("a.nmea", "$GPGGA,120000,0000.000,N,00000.000,E,0,08,0.9,0,M,0,M,,\n");
  expectFault(65, "no valid fix in it", "nmea", {"--track", file("a.nmea")});
  write("b.nmea", kGga);
  expectFault(64, "--date 'today'", "nmea", {"--track", file("b.nmea"), "--date", "today"});
  write("a.gpx", "<gpx><trk><trkseg><trkpt lat='x' lon='0'/></trkseg></trk></gpx>");
  expectFault(65, "a.gpx:1: <trkpt>", "gpx", {"--track", file("a.gpx")});
  write("a.gpx", "<gpx");
  expectFault(65, "a.gpx", "gpx", {"--track", file("a.gpx")});
}

}  // namespace
}  // namespace perception
