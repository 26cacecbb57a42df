// Drives in the layouts of CADC, Boreas and SemanticSpray are written here: a road 1.9 m below the
// lidar, and a car of 4 m that is overtaken by us at a known speed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <variant>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

constexpr double kRoadBelow = 1.9;                 // [m]
constexpr double kWinterStep = 1;                  // [m] a scan
constexpr std::int64_t kWinterStart = 1611678137;  // [s]
constexpr int kWinterScans = 8;
constexpr double kCarAhead = 15, kCarLeft = 3.5;  // [m] at the first scan; it stands

/// Rows of x, y, z, intensity (bytes), and what else a set has. `turn`: bearing of the way ahead in
/// the lidar's frame.
std::vector<float> winterScan(int k, double turn, const std::vector<float>& more) {
  std::vector<float> numbers;
  const auto put = [&](double x, double y, double z) {
    const Vector2 at = rotate2(turn, {x, y});
    for (const double v : {at.x(), at.y(), z, 120.0}) numbers.push_back(static_cast<float>(v));
    numbers.insert(numbers.end(), more.begin(), more.end());
  };
  for (int i = 0; i < 600; ++i) {
    const double azimuth = 0.0105 * i, range = 5 + i % 3 * 4;
    put(range * std::cos(azimuth), range * std::sin(azimuth), -kRoadBelow);
  }
  const double x = kCarAhead - kWinterStep * k;
  for (int i = 0; i <= 40; ++i) put(x - 2 + 0.1 * i, kCarLeft - 0.9, -1);
  return numbers;
}

class WinterSets : public test::ImportRun {
 protected:
  void expectScans(double to_the_left = 0) {
    const auto scans = framesOf("LIDAR_TOP");
    ASSERT_EQ(scans.size(), static_cast<std::size_t>(kWinterScans));
    const auto& cloud = std::get<LidarCloud>(scans[3].data);
    EXPECT_EQ(cloud.size(), 641U);
    EXPECT_NEAR(cloud.intensity[0], 120.0 / 255, 1e-6);
    EXPECT_NEAR(scans[3].T_ego_sensor.translation().z(), kRoadBelow, 0.03);
    EXPECT_NEAR(yawOf(scans[3].T_ego_sensor), -to_the_left, 1e-3);
    const Pose3& ego = scans[3].ego.T_world_ego;
    EXPECT_NEAR(ego.translation().x(), 3 * kWinterStep, 0.01);
    EXPECT_NEAR(ego.translation().y(), 0, 0.01);
  }
  /// The car stands where it is, with its size and returns.
  void expectTruth(const std::string& type) {
    const GroundTruth truth = readGroundTruth(file("out.truth.csv"));
    ASSERT_EQ(truth.instants.size(), static_cast<std::size_t>(kWinterScans));
    for (const GroundTruth::Instant& instant : {truth.instants[0], truth.instants[6]}) {
      ASSERT_EQ(instant.objects.size(), 1U);
      const TruthObject& car = instant.objects[0];
      EXPECT_EQ(car.type, type);
      EXPECT_NEAR(car.position.x(), kCarAhead, 0.02);
      EXPECT_NEAR(car.position.y(), kCarLeft, 0.02);
      EXPECT_NEAR(std::sin(car.yaw), 0, 1e-3);
      EXPECT_NEAR(car.length, 4.2, 1e-6);
      EXPECT_NEAR(car.width, 1.9, 1e-6);
      EXPECT_NEAR(std::hypot(car.vx, car.vy), 0, 0.1);
      EXPECT_EQ(car.lidar_points, 41);
      EXPECT_FALSE(car.ignore);
    }
  }

  void writeCadc() const {
    std::string stamps, frames;
    for (int k = 0; k < kWinterScans; ++k) {
      const std::string number = fmt::format("{:010}", k);
      write("day/0001/labeled/lidar_points/data/" + number + ".bin", bytesOf(winterScan(k, 0, {})));
      // Toward the east: azimuth 90 deg.
      write("day/0001/labeled/novatel/data/" + number + ".txt",
            fmt::format("43.5 {:.12f} 330 -36 0.01 0.01 0.02 0 0 90 0 0 0\n",
                        -80.5 + kWinterStep * k / (111319.4908 * std::cos(radians(43.5)))));
      stamps += fmt::format("2018-03-06 20:24:{:02}.500000000\n", 10 + k);
      frames += fmt::format(
          R"({}{{"cuboids":[{{"uuid":"a-b","label":"Car","position":{{"x":{},"y":{},"z":-1}},)"
          R"("dimensions":{{"x":1.9,"y":4.2,"z":1.5}},"yaw":0,"stationary":true}}]}})",
          k > 0 ? "," : "", kCarAhead - kWinterStep * k, kCarLeft);
    }
    write("day/0001/labeled/lidar_points/timestamps.txt", stamps);
    write("day/0001/labeled/novatel/timestamps.txt", stamps);
    write("day/0001/3d_ann.json", "[" + frames + "]");
    write("day/calib/extrinsics.yaml",
          "T_LIDAR_GPSIMU:\n- [1.0, 0.0, 0.0, -1.5]\n- [0.0, 1.0, 0.0, 0.25]\n"
          "- [0.0, 0.0, 1.0, -0.5]\n- [0.0, 0.0, 0.0, 1.0]\n");
  }

  /// The lidar looks 30 deg to the right of the way: ahead is to the left in its frame.
  static constexpr double kTurned = kPi / 6;
  static std::string microseconds(int k) {
    return std::to_string(kWinterStart * 1'000'000 + 100'000 * k);
  }
  void writeBoreas() const {
    std::string poses =
        "GPSTime,easting,northing,altitude,vel_east,vel_north,vel_up,roll,pitch,"
        "heading,angvel_z,angvel_y,angvel_x\n";
    for (int k = 0; k < kWinterScans; ++k) {
      write("b/lidar/" + microseconds(k) + ".bin", bytesOf(winterScan(k, kTurned, {3, -0.02F})));
      // To the north (90 deg in ENU), the lidar's x axis at 90 - 30 deg: heading -60 deg.
      poses += fmt::format("{},100,{},50,0,10,0,0,0,{:.9f},0,0,0\n", microseconds(k),
                           200 + kWinterStep * k, -kPi / 3);
      const Vector2 at = rotate2(kTurned, {kCarAhead - kWinterStep * k, kCarLeft});
      write("b/labels_tracking/" + microseconds(k) + ".txt",
            fmt::format("u1 Car 4.2 1.9 1.5 {} {} -1 {} 41\n", at.x(), at.y(), kTurned));
    }
    write("b/applanix/lidar_poses.csv", poses);
    write("b/calib/T_radar_lidar.txt", "1 0 0 0\n0 -1 0 0\n0 0 -1 0.25\n0 0 0 1\n");
    // One echo at cell 400, a quarter of a turn (encoder 1400) clockwise.
    cv::Mat picture = cv::Mat::zeros(400, 11 + 800, CV_8UC1);
    for (int row = 0; row < 400; ++row) {
      const int encoder = 14 * row;
      picture.at<std::uint8_t>(row, 8) = static_cast<std::uint8_t>(encoder % 256);
      picture.at<std::uint8_t>(row, 9) = static_cast<std::uint8_t>(encoder / 256);
    }
    picture.at<std::uint8_t>(100, 11 + 400) = 200;
    std::filesystem::create_directories(file("b/radar"));
    cv::imwrite(file("b/radar/" + microseconds(2) + ".png"), picture);
  }
  void writeSpray() const {
    std::string poses;
    for (int k = 0; k < kWinterScans; ++k) {
      const auto numbers = winterScan(k, 0, {5});
      write(fmt::format("s/velodyne/{:06}.bin", k), bytesOf(numbers));
      std::vector<std::uint32_t> labels(numbers.size() / 5, 0);
      std::fill(labels.end() - 41, labels.end(), 1);
      write(fmt::format("s/labels/{:06}.label", k), bytesOf(labels));
      write(fmt::format("s/object_labels/lidar/{:06}.json", k),
            fmt::format(R"([{{"instances":[{{"contour":{{"center3D":{{"x":{},"y":{},"z":-1}},)"
                        R"("size3D":{{"x":4.2,"y":1.9,"z":1.5}},)"
                        R"("rotation3D":{{"x":0,"y":0,"z":180}}}}}}]}}])",
                        kCarAhead - kWinterStep * k, kCarLeft));
      poses += fmt::format("1 0 0 {} 0 1 0 0 0 0 1 0\n", kWinterStep * k);
    }
    write("s/poses.txt", poses);
    std::filesystem::create_directories(file("s/ibeo_front"));
  }
};

TEST_F(WinterSets, ADriveOfCadcHasItsPlaceFromTheReceiverAndItsTruth) {
  writeCadc();
  ASSERT_EQ(import("cadc", {"--dir", file("day/0001/labeled")}), 0) << error_;
  expectScans();
  expectTruth("Car");
}

TEST_F(WinterSets, CadcWithoutItsCalibrationOrLabelsSaysSo) {
  writeCadc();
  std::filesystem::remove_all(file("day/calib"));
  std::filesystem::remove(file("day/0001/3d_ann.json"));
  ASSERT_EQ(import("cadc", {"--dir", file("day/0001/labeled")}), 3) << error_;
  EXPECT_NE(error_.find("the GPS/IMU is taken to be at the lidar"), std::string::npos) << error_;
  EXPECT_FALSE(std::filesystem::exists(file("out.truth.csv")));
}

TEST_F(WinterSets, AnAzimuthThatIsNotTheWayOfTheVehicleIsTold) {
  writeCadc();
  for (int k = 0; k < kWinterScans; ++k)
    write(fmt::format("day/0001/labeled/novatel/data/{:010}.txt", k),
          fmt::format("43.5 {:.12f} 330 -36 0.01 0.01 0.02 0 0 180 0 0 0\n", -80.5 + 1e-5 * k));
  ASSERT_EQ(import("cadc", {"--dir", file("day/0001/labeled")}), 3) << error_;
  EXPECT_NE(error_.find("does not travel to where its azimuth points"), std::string::npos);
}

TEST_F(WinterSets, DamagedFilesOfCadcAreNamed) {
  writeCadc();
  write("day/0001/3d_ann.json", R"([{"cuboids": [{"uuid": "a", "label": "Car"}]}])");
  expectFault(65, "frames[0].cuboids[0]: expected a member dimensions", "cadc",
              {"--dir", file("day/0001/labeled")});
  write("day/0001/labeled/novatel/data/0000000002.txt", "43.5 -80.5 330\n");
  expectFault(65, "0000000002.txt:1: 3 fields", "cadc", {"--dir", file("day/0001/labeled")});
}

TEST_F(WinterSets, ALidarOfBoreasIsTurnedByItsWay) {
  writeBoreas();
  ASSERT_EQ(import("boreas", {"--dir", file("b")}), 0) << error_;
  expectScans(kTurned);
  expectTruth("Car");
  const auto cloud = std::get<LidarCloud>(framesOf("LIDAR_TOP")[0].data);
  EXPECT_NEAR(cloud.time_offset[5], -0.02, 1e-6) << "about the middle of the turn";
  EXPECT_EQ(cloud.ring[5], 3);
}

TEST_F(WinterSets, ARadarOfBoreasTurnsClockwise) {
  writeBoreas();
  ASSERT_EQ(import("boreas", {"--dir", file("b")}), 0) << error_;
  const auto turns = framesOf("RADAR_TOP");
  ASSERT_EQ(turns.size(), 1U);
  const auto& returns = std::get<RadarReturns>(turns[0].data).returns;
  ASSERT_EQ(returns.size(), 1U);
  EXPECT_NEAR(returns[0].range, 400 * 0.0596 - 0.31, 1e-6);
  EXPECT_FALSE(returns[0].has_rate);
  // In the vehicle's frame: the radar's axes are the lidar's, upside down.
  const Vector3 at =
      turns[0].T_ego_sensor * Vector3(returns[0].range * std::cos(returns[0].bearing),
                                      returns[0].range * std::sin(returns[0].bearing), 0);
  EXPECT_NEAR(std::atan2(at.y(), at.x()), -kPi / 2 - kTurned, 1e-3);
}

TEST_F(WinterSets, PosesOfBoreasWithOtherAttitudesAreRefused) {
  writeBoreas();
  std::string poses;
  for (int k = 0; k < kWinterScans; ++k)
    poses += fmt::format("{},100,{},50,0,10,0,0,0,{},0,0,0\n", microseconds(k), 200 + k, k);
  write("b/applanix/lidar_poses.csv", poses);
  expectFault(65, "the lidar travels to no direction of its own", "boreas", {"--dir", file("b")});
}

TEST_F(WinterSets, ScansInSprayKeepTheirLabelsAndBoxes) {
  writeSpray();
  ASSERT_EQ(import("semanticspray", {"--dir", file("s")}), 0) << error_;
  expectScans();
  expectTruth("Car");
  EXPECT_TRUE(std::filesystem::exists(file("out_Labels/000007.label")));
  std::string notes;
  for (const std::string& note : result_.notes) notes += note + "\n";
  EXPECT_NE(notes.find("label 1 (vehicle ahead): 328 points"), std::string::npos) << notes;
  EXPECT_NE(notes.find("delphi_radar/ and image_2/ are not taken"), std::string::npos) << notes;
}

TEST_F(WinterSets, TheirInisTrack) {
  writeCadc();
  ASSERT_EQ(import("cadc", {"--dir", file("day/0001/labeled")}), 0) << error_;
  EXPECT_EQ(track("cadc.ini", "L").size(), static_cast<std::size_t>(kWinterScans));
  writeBoreas();
  std::filesystem::remove(file("out.rawlog"));
  ASSERT_EQ(import("boreas", {"--dir", file("b")}), 0) << error_;
  EXPECT_EQ(track("boreas.ini", "L").size(), static_cast<std::size_t>(kWinterScans));
  writeSpray();
  std::filesystem::remove(file("out.rawlog"));
  ASSERT_EQ(import("semanticspray", {"--dir", file("s")}), 0) << error_;
  EXPECT_EQ(track("semanticspray.ini", "L").size(), static_cast<std::size_t>(kWinterScans));
}

}  // namespace
}  // namespace perception
