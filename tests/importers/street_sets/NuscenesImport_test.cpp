// A data set in nuScenes' layout is written here: two scenes, the second of three key frames with
// one sweep between them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/GroundTruth.h"
#include "libperception/importers/street_sets/NuscenesTables.h"
#include "libperception/interop/exports/NuscenesFile.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

constexpr std::int64_t kStartUs = 1'533'000'000'000'000;

/// A vehicle drives 5 m/s along the global y axis from (100, 50); a car stands 20 m ahead of its
/// start.
class NuscenesImport : public test::ImportRun {
 protected:
  void SetUp() override {
    table("scene",
          R"({"token": "s0", "name": "scene-0001", "description": "other", "nbr_samples": 1},
                      {"token": "s1", "name": "scene-0061", "description": "Rain", "nbr_samples": 3})");
    std::string samples = R"({"token": "k9", "timestamp": 1000, "scene_token": "s0"})";
    std::string data, poses, annotations;
    for (int k = 0; k < 3; ++k) {
      const std::int64_t us = kStartUs + k * 500'000;
      samples +=
          fmt::format(R"(, {{"token": "k{}", "timestamp": {}, "scene_token": "s1"}})", k, us);
      append(data, poses, k, us, true, "lidar");
      if (k == 1) append(data, poses, k, us - 250'000, false, "lidar");
      append(data, poses, k, us + 20'000, true, "radar");
      annotations += fmt::format(
          R"({}{{"sample_token": "k{}", "instance_token": "i0", "translation": [100, {}, 1],
          "size": [2, 4, 1.5], "rotation": [0.70710678, 0, 0, 0.70710678], "attribute_tokens": [],
          "num_lidar_pts": {}, "num_radar_pts": 0}})",
          k > 0 ? ", " : "", k, 70 + k, 5 - k);
    }
    table("sample", samples), table("sample_data", data), table("ego_pose", poses);
    table("sample_annotation", annotations + R"(, {"sample_token": "k0", "instance_token": "i1",
        "translation": [90, 50, 1], "size": [1, 1, 2], "rotation": [1, 0, 0, 0],
        "attribute_tokens": ["a0"], "num_lidar_pts": 3, "num_radar_pts": 0})");
    table("sensor", R"({"token": "l", "channel": "LIDAR_TOP", "modality": "lidar"},
                       {"token": "r", "channel": "RADAR_FRONT", "modality": "radar"})");
    // The lidar's own frame: x right, y forward.
    table("calibrated_sensor", R"({"token": "cl", "sensor_token": "l", "translation": [0.9, 0, 1.8],
        "rotation": [0.70710678, 0, 0, -0.70710678], "camera_intrinsic": []},
        {"token": "cr", "sensor_token": "r", "translation": [3.4, 0, 0.5],
        "rotation": [1, 0, 0, 0], "camera_intrinsic": []})");
    table("instance",
          R"({"token": "i0", "category_token": "c0"}, {"token": "i1", "category_token": "c1"})");
    table("category",
          R"({"token": "c0", "name": "vehicle.car"}, {"token": "c1", "name": "vehicle.bicycle"})");
    table("attribute", R"({"token": "a0", "name": "cycle.without_rider"})");
  }
  void table(const std::string& name, const std::string& rows) {
    write("n/v1.0-mini/" + name + ".json", "[" + rows + "]");
  }
  void append(std::string& data, std::string& poses, int sample, std::int64_t us, bool key,
              const std::string& kind) {
    const std::string name = fmt::format("{}_{}", kind, us), comma = data.empty() ? "" : ", ";
    const std::string path = fmt::format("{}/{}/{}.{}", key ? "samples" : "sweeps", kind, name,
                                         kind == "lidar" ? "pcd.bin" : "pcd");
    data += fmt::format(
        R"({}{{"token": "d{}", "sample_token": "k{}", "ego_pose_token": "p{}",
        "calibrated_sensor_token": "c{}", "timestamp": {}, "is_key_frame": {}, "filename": "{}"}})",
        comma, name, sample, name, kind[0], us, key, path);
    poses += fmt::format(
        R"({}{{"token": "p{}", "timestamp": {}, "translation": [100, {}, 0],
        "rotation": [0.70710678, 0, 0, 0.70710678]}})",
        comma, name, us, 50 + 5e-6 * static_cast<double>(us - kStartUs));
    write("n/" + path,
          kind == "lidar" ? bytesOf<float>({0, 10, -1, 51, 3, 2, 20, -1, 255, 31}) : radarFile());
  }
  /// Two targets, the second invalid.
  static std::string radarFile() {
    std::string bytes =
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y id rcs vx vy invalid_state ambig_state\n"
        "SIZE 4 4 2 4 4 4 1 1\nTYPE F F I F F F I I\nCOUNT 1 1 1 1 1 1 1 1\nWIDTH 2\nHEIGHT 1\n"
        "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA binary\n";
    for (const char invalid : {'\0', '\4'}) {
      bytes += bytesOf<float>({30, 40}) + bytesOf<std::int16_t>({7});
      bytes += bytesOf<float>({12, -3, -4}) + invalid + '\3';
    }
    return bytes;
  }
  std::vector<std::string> scene(const std::string& name) const {
    return {"--dir", file("n"), "--scene", name};
  }
};

TEST_F(NuscenesImport, KeyFramesAndWhatLiesBetweenBecomeScansWithPoses) {
  ASSERT_EQ(import("nuscenes", scene("scene-0061")), 0) << error_;
  EXPECT_EQ(frameNumbers(), (std::vector<std::int64_t>{0, 1, 2}));
  const auto scans = framesOf("LIDAR_TOP");
  ASSERT_EQ(scans.size(), 4u);
  EXPECT_EQ(scans[1].stamp.ns - scans[0].stamp.ns, 250'000'000);
  // The world is the vehicle's frame at the first scan.
  EXPECT_TRUE(scans[3].ego.T_world_ego.isApprox(makePose(5, 0, 0, 0), 1e-5));
  const auto& cloud = std::get<LidarCloud>(scans[0].data);
  ASSERT_EQ(cloud.size(), 2u);
  EXPECT_TRUE((scans[0].T_ego_sensor * Vector3(cloud.x[0], cloud.y[0], cloud.z[0]))
                  .isApprox(Vector3(10.9, 0, 0.8), 1e-5));
  EXPECT_EQ(cloud.ring[1], 31);
  EXPECT_NEAR(static_cast<double>(cloud.intensity[0]), 0.2, 1e-6);
}

TEST_F(NuscenesImport, RadarTargetsHaveTheirSpeedAlongTheBeamAndInvalidOnesAreLeftOut) {
  ASSERT_EQ(import("nuscenes", scene("scene-0061")), 0) << error_;
  const auto scans = framesOf("RADAR_FRONT");
  ASSERT_EQ(scans.size(), 3u);
  const auto& returns = std::get<RadarReturns>(scans[0].data).returns;
  ASSERT_EQ(returns.size(), 1u);
  EXPECT_NEAR(returns[0].range, 50, 1e-4);
  EXPECT_NEAR(returns[0].bearing, std::atan2(40, 30), 1e-6);
  EXPECT_NEAR(returns[0].range_rate, -5, 1e-4);
  EXPECT_EQ(returns[0].id, 7);
}

TEST_F(NuscenesImport, BoxesOfKeyFramesAreTheTruthWithVelocitiesByDifferences) {
  ASSERT_EQ(import("nuscenes", scene("scene-0061")), 0) << error_;
  const auto truth = readGroundTruth(file("out.truth.csv"));
  ASSERT_EQ(truth.instants.size(), 3u);
  ASSERT_EQ(truth.instants[0].objects.size(), 2u);
  const TruthObject& car = truth.instants[1].objects[0];
  EXPECT_EQ(car.type, "Car");
  EXPECT_FALSE(car.ignore);
  EXPECT_TRUE(car.position.isApprox(Vector3(21, 0, 0.25), 1e-3)) << car.position.transpose();
  EXPECT_NEAR(car.yaw, 0, 1e-4);
  EXPECT_NEAR(car.length, 4, 1e-6);
  EXPECT_NEAR(car.vx, 2, 1e-3);
  EXPECT_EQ(car.lidar_points, 4);
  const TruthObject& bicycle = truth.instants[0].objects[1];
  EXPECT_EQ(bicycle.type, "Bicycle");
  EXPECT_TRUE(bicycle.ignore) << "it has no rider";
}

TEST_F(NuscenesImport, TokensOfTheKeyFramesAreKeptBesideTheLog) {
  ASSERT_EQ(import("nuscenes", scene("scene-0061")), 0) << error_;
  const NuscenesSamples samples = readNuscenesSamples(file("out.samples.csv"));
  ASSERT_EQ(samples.tokens.size(), 3u);
  EXPECT_EQ(samples.tokens[2].second, "k2");
  EXPECT_TRUE(samples.T_global_world.isApprox(makePose(100, 50, 0, radians(90)), 1e-5));
}

TEST_F(NuscenesImport, ADownloadWithoutSweepsIsReadAndTheLackIsSaid) {
  std::filesystem::remove_all(file("n/sweeps"));
  ASSERT_EQ(import("nuscenes", scene("scene-0061")), 3) << error_;
  EXPECT_NE(error_.find("LIDAR_TOP: 1 files are not there"), std::string::npos) << error_;
  EXPECT_EQ(framesOf("LIDAR_TOP").size(), 3u);
}

TEST_F(NuscenesImport, FaultsNameTableAndRow) {
  expectFault(64, "2 scenes: scene-0001, scene-0061", "nuscenes", {"--dir", file("n")});
  expectFault(66, "v1.0-trainval/scene.json: no such file", "nuscenes",
              {"--dir", file("n"), "--version", "v1.0-trainval"});
  table("ego_pose", "");
  expectFault(65, "ego_pose.json has no row plidar_", "nuscenes", scene("scene-0061"));
  write("n/v1.0-mini/sample.json", "[{\"token\": 5}]");
  expectFault(65, "sample.json: row 1: scene_token: expected to be there", "nuscenes",
              scene("scene-0061"));
  write("n/v1.0-mini/sample.json", "[{\"token\": ");
  expectFault(65, "sample.json: behind row 0: not JSON", "nuscenes", scene("scene-0061"));
}

TEST_F(NuscenesImport, CategoriesBecomeTypes) {
  EXPECT_EQ(nuscenesTypeOf("human.pedestrian.child", {}), "Pedestrian");
  EXPECT_EQ(nuscenesTypeOf("human.pedestrian.personal_mobility", {}), "PersonalMobility");
  EXPECT_EQ(nuscenesTypeOf("vehicle.bus.bendy", {}), "Bus");
  EXPECT_EQ(nuscenesTypeOf("vehicle.truck", {}), "Truck");
  EXPECT_EQ(nuscenesTypeOf("vehicle.bicycle", {"cycle.with_rider"}), "Cyclist");
  EXPECT_EQ(nuscenesTypeOf("movable_object.trafficcone", {}), "Trafficcone");
}

TEST_F(NuscenesImport, ASceneIsTracked) {
  ASSERT_EQ(import("nuscenes", scene("scene-0061")), 0) << error_;
  EXPECT_EQ(track("nuscenes.ini", "L").size(), 4u);
}

}  // namespace
}  // namespace perception
