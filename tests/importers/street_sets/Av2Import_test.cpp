#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "libperception/core/Csv.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/importers/truth/TruthTypes.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

namespace fs = std::filesystem;
using test::sharedData;

constexpr const char* kScans =
    "scan,log,timestamp_ns,points,boxes,qw,qx,qy,qz,tx,ty,tz\n"
    "0,aaaa-1,1000000000000000000,2,1,1,0,0,0,100,50,10\n"
    "1,aaaa-1,1000000000100000000,1,1,1,0,0,0,101,50,10\n"
    "2,bbbb-2,1000900000000000000,1,1,1,0,0,0,900,50,10\n";
constexpr const char* kBoxes =
    "scan,track,category,x,y,z,length,width,height,yaw,points\n"
    "0,000000ff,REGULAR_VEHICLE,10,0,0.45,4,2,1.5,0,1\n"
    "1,000000ff,REGULAR_VEHICLE,10,0,0.45,4,2,1.5,0,1\n"
    "2,00000010,CONSTRUCTION_CONE,5,0,0,1,1,1,0,0\n";
constexpr const char* kAv2Calibration =
    "sensor_name,qw,qx,qy,qz,tx_m,ty_m,tz_m\n"
    "down_lidar,0,1,0,0,1,0,1.2\n"
    "up_lidar,1,0,0,0,1,0,1.5\n";

/// Two drives of a vehicle whose lidar stands 1 m ahead of the rear axle.
class Av2Import : public test::ImportRun {
 protected:
  void SetUp() override {
    write("a/scans.csv", kScans);
    write("a/boxes.csv", kBoxes);
    write("a/calib.csv", kAv2Calibration);
    writeGz("a/lidar/000000.bin.gz", bytesOf<float>({10, 0, 0.5F, 0.25F, 30, 0, 0.5F, 1}));
    write("a/lidar/000001.bin", bytesOf<float>({10, 0, 0.5F, 0.25F}));
    write("a/lidar/000002.bin", bytesOf<float>({5, 3, 0, 1}));
  }
  std::vector<std::string> dir() const { return {"--dir", file("a")}; }
};

TEST_F(Av2Import, CategoriesBecomeKittisTypes) {
  EXPECT_EQ(truthTypeOf("REGULAR_VEHICLE"), "Car");
  EXPECT_EQ(truthTypeOf("PEDESTRIAN"), "Pedestrian");
  EXPECT_EQ(truthTypeOf("BICYCLIST"), "Cyclist");
  EXPECT_EQ(truthTypeOf("BOX_TRUCK"), "Truck");
  EXPECT_EQ(truthTypeOf("VAN"), "Van");
  EXPECT_EQ(truthTypeOf("CONSTRUCTION_CONE"), "ConstructionCone");
  EXPECT_EQ(truthTypeOf("stop_Sign2"), "StopSign2");
  EXPECT_EQ(truthTypeOf(""), "");
}

TEST_F(Av2Import, TheVehiclesOriginIsPutOnTheGround) {
  ASSERT_EQ(import("av2", dir()), 0) << error_;
  const auto frames = framesOf("LIDAR_TOP");
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_TRUE(frames[0].T_ego_sensor.isApprox(makePose(1, 0, 1.83, 0), 1e-9));
  const auto& cloud = std::get<LidarCloud>(frames[0].data);
  ASSERT_EQ(cloud.size(), 2u);
  EXPECT_FLOAT_EQ(cloud.x[0], 9);  // the lidar's own frame
  EXPECT_FLOAT_EQ(cloud.z[0], -1);
  EXPECT_FLOAT_EQ(cloud.intensity[0], 0.25F);
  const auto truth = readGroundTruth(file("out.truth.csv"));
  ASSERT_EQ(truth.instants.size(), 3u);
  const TruthObject& car = truth.instants[0].objects.at(0);
  EXPECT_EQ(car.id, 255);
  EXPECT_EQ(car.type, "Car");
  EXPECT_FALSE(car.ignore);
  EXPECT_EQ(car.lidar_points, 1);
  EXPECT_TRUE(car.position.isApprox(Vector3(10, 0, 0.03), 1e-6)) << car.position.transpose();
  EXPECT_NEAR(car.vx, 10, 1e-6);  // as fast as the vehicle
  EXPECT_TRUE(truth.instants[2].objects.at(0).ignore);
}

TEST_F(Av2Import, DrivesShareNeitherTimeNorPlace) {
  ASSERT_EQ(import("av2", dir()), 0) << error_;
  const auto frames = framesOf("LIDAR_TOP");
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].stamp.ns, 1'000'000'000'000'000'000);
  EXPECT_NEAR(frames[1].stamp - frames[0].stamp, 0.1, 1e-9);
  EXPECT_NEAR(frames[2].stamp - frames[1].stamp, 10, 1e-6);
  EXPECT_NEAR(frames[0].ego.velocity.x(), 10, 1e-6);
  EXPECT_NEAR(frames[1].ego.velocity.x(), 10, 1e-6);
  EXPECT_NEAR(frames[2].ego.velocity.norm(), 0, 1e-6);
  EXPECT_TRUE(frames[1].ego.T_world_ego.isApprox(makePose(1, 0, 0, 0), 1e-9));
  EXPECT_TRUE(frames[2].ego.T_world_ego.isApprox(makePose(500, 0, 0, 0), 1e-9));
  ASSERT_EQ(import("av2", {"--dir", file("a"), "--log", "bbbb"}), 0) << error_;
  EXPECT_EQ(framesOf("LIDAR_TOP").at(0).stamp.ns, 1'000'900'000'000'000'000);
  EXPECT_EQ(frameNumbers(), (std::vector<std::int64_t>{2}));
}

TEST_F(Av2Import, AScanShownRepeatedlyIsAStillWorld) {
  ASSERT_EQ(import("av2", {"--dir", file("a"), "--repeat", "4", "--last", "1"}), 0) << error_;
  const auto frames = framesOf("LIDAR_TOP");
  ASSERT_EQ(frames.size(), 8u);
  EXPECT_NEAR(frames[3].stamp - frames[0].stamp, 0.015, 1e-6);
  EXPECT_NEAR(frames[4].stamp - frames[3].stamp, 10, 1e-6);
  for (const auto& frame : frames) EXPECT_NEAR(frame.ego.velocity.norm(), 0, 1e-6);
  EXPECT_EQ(result_.truth_rows, 2u);
  EXPECT_EQ(frameNumbers(), (std::vector<std::int64_t>{0, 1}));
}

TEST_F(Av2Import, FaultsNameFileLineAndColumn) {
  expectFault(66, "nowhere", "av2", {"--dir", file("nowhere")});
  expectFault(64, "--log cc: no such log", "av2", {"--dir", file("a"), "--log", "cc"});
  expectFault(65, "scans.csv: none of the wanted scans", "av2",
              {"--dir", file("a"), "--first", "7"});
  const auto damaged = [&](const std::string& name, const std::string& text,
                           const std::string& message) {
    SetUp();
    write(name, text);
    expectFault(65, message, "av2", dir());
  };
  const std::string scans = kScans, boxes = kBoxes;
  damaged("a/scans.csv", scans.substr(0, scans.size() - 4), "scans.csv:4: the file ends within");
  damaged("a/scans.csv", scans + "3,bbbb-2,1000900000000000000,1,1,1,0,0,0,900,50,10\n",
          "scans.csv:5: column 'timestamp_ns': found '1000900000000000000', expected a later");
  damaged("a/scans.csv", scans + "3,cccc,1000900000000000000,1,1,1,1,0,0,900,50,10\n",
          "scans.csv:5: qw to qz: no unit quaternion");
  damaged("a/boxes.csv", boxes + "2,xyz,SIGN,5,0,0,1,1,1,0,0\n",
          "boxes.csv:5: column 'track': found 'xyz', expected up to 8 hexadecimal digits");
  damaged("a/boxes.csv", boxes + "2,0a,SIGN,5,0,0,1,0,1,0,0\n",
          "boxes.csv:5: column 'width': found '0', expected a size above 0");
  damaged("a/boxes.csv", "scan,track\n", "boxes.csv:1: found no column 'category'");
  damaged("a/calib.csv", "sensor_name,qw,qx,qy,qz,tx_m,ty_m,tz_m\n", "calib.csv: no row up_lidar");
  damaged("a/lidar/000001.bin", bytesOf<float>({1, 2, 3, 0, 4, 5, 6, 0}),
          "000001.bin: 2 points, expected 1 as in ");
  SetUp();
  fs::remove(file("a/lidar/000001.bin"));
  EXPECT_EQ(import("av2", dir()), 3);
  EXPECT_NE(error_.find("no scan for 1 of 3 frames (first: 1)"), std::string::npos) << error_;
}

// ------------------------------------------------------------------------- as it was published

TEST_F(Av2Import, BoxesHoldThePublishedNumbersOfReturns) {
  NEEDS_SHARED_DATA("av2_scans");
  ASSERT_EQ(import("av2", {"--dir", sharedData("av2_scans")}), 0) << error_;
  EXPECT_EQ(result_.points, 99229u + 99466u + 100660u);
  EXPECT_EQ(result_.truth_rows, 209u);
  EXPECT_EQ(result_.truth_types.at("Car"), 107u);
  EXPECT_EQ(result_.truth_types.at("Pedestrian"), 46u);
  EXPECT_EQ(result_.truth_types.at("Bus"), 3u);
  EXPECT_EQ(result_.truth_types.at("Truck"), 7u);  // 3 box trucks, 2 cabs, 1 truck, 1 large vehicle
  EXPECT_EQ(result_.truth_types.at("Bollard"), 17u);
  const CsvTable published = CsvTable::fromFile(sharedData("av2_scans/boxes.csv"));
  std::size_t row = 0;
  int returns = 0, apart = 0;
  for (const auto& instant : readGroundTruth(file("out.truth.csv")).instants) {
    for (const TruthObject& o : instant.objects) {
      const auto expected = static_cast<int>(published.integer(row++, published.column("points")));
      EXPECT_NEAR(o.lidar_points, expected, 2 + 0.021 * expected) << o.frame << " " << o.id;
      returns += o.lidar_points;
      apart += o.lidar_points == expected ? 0 : 1;
    }
  }
  ASSERT_EQ(row, 209u);
  RecordProperty("returns", returns);
  RecordProperty("boxes_apart", apart);
  EXPECT_NEAR(returns, 36660, 40);  // places are rounded to a millimeter, returns to 1/128 m
}

TEST_F(Av2Import, NothingOfOneScanLivesInTheNextAndParkedCarsAreTracked) {
  NEEDS_SHARED_DATA("av2_scans");
  ASSERT_EQ(import("av2", {"--dir", sharedData("av2_scans"), "--repeat", "10"}), 0) << error_;
  const auto scenes = track("av2.ini", "L");
  ASSERT_EQ(scenes.size(), 30u);
  std::map<std::uint64_t, std::size_t> scan_of;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    for (const auto& object : scenes[i].objects) {
      EXPECT_EQ(scan_of.emplace(object.id, i / 10).first->second, i / 10) << object.id;
    }
  }
  int near = 0, tracked = 0;
  for (const auto& instant : readGroundTruth(file("out.truth.csv")).instants) {
    const auto scene = std::find_if(scenes.begin(), scenes.end(),
                                    [&](const Scene& s) { return s.frame == instant.frame; });
    ASSERT_NE(scene, scenes.end());
    for (const TruthObject& o : instant.objects) {
      const double range = (o.position - scene->ego.T_world_ego.translation()).head<2>().norm();
      if (o.type != "Car" || o.lidar_points < 100 || range > 40) continue;
      ++near;
      tracked += std::any_of(scene->objects.begin(), scene->objects.end(), [&](const auto& object) {
        return (object.position - o.position).template head<2>().norm() < 2;
      });
    }
  }
  RecordProperty("near", near);
  RecordProperty("tracked", tracked);
  ASSERT_GE(near, 10);
  EXPECT_GE(tracked, (9 * near) / 10);
}

}  // namespace
}  // namespace perception
