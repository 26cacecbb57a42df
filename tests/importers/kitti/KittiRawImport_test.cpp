// A drive in the layout of KITTI's raw data is written here: three scans 0.1 s apart at 8 m/s to
// the east, one car that stands.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/importers/kitti/KittiRawFiles.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

constexpr double kEastward = 8, kCarAt = 20;  // [m/s], [m] ahead of the first scan

class KittiRawImport : public test::ImportRun {
 protected:
  void SetUp() override {
    write("day/calib_velo_to_cam.txt",
          "calib_time: 15-Mar-2012 11:37:16\nR: 0 -1 0 0 0 -1 1 0 0\nT: 0 0 -0.27\ndelta_f: 0 0\n");
    write("day/calib_imu_to_velo.txt",
          "calib_time: 25-May-2012 16:47:16\nR: 1 0 0 0 1 0 0 0 1\nT: -0.8 0.3 -0.8\n");
    write("day/calib_cam_to_cam.txt",
          "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 9.95e-02\n"
          "R_rect_00: 1 0 0 0 1 0 0 0 1\nP_rect_02: 721.5 0 609.6 44.86 0 721.5 172.9 0.2 0 0 1 "
          "0.003\n");
    std::string times, boxes;
    for (int k = 0; k < 3; ++k) {
      times += fmt::format("2011-09-26 13:02:25.{:09}\n", 100'000'000 + k * 100'000'000);
      const double x = kEastward * 0.1 * k;
      // A degree of longitude at latitude 0 [m].
      const double degree = radians(1) * 6378137;
      write(fmt::format("day/drive/oxts/data/{:010}.txt", k),
            fmt::format("0 {:.12f} 110 0 0 0 0 8 8 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 4 9 4 4 0\n",
                        x / degree));
      const auto ahead = static_cast<float>(kCarAt - x);
      write(fmt::format("day/drive/velodyne_points/data/{:010}.bin", k),
            bytesOf<float>({ahead, 0, -1, 0.5F, ahead, 0.5F, -1, 0.25F, 5, 5, -1.7F, 0.1F}));
      boxes += fmt::format(
          "<item><tx>{}</tx><ty>0</ty><tz>-1.7</tz><rx>0</rx><ry>0</ry><rz>0.1</rz>"
          "<state>2</state><occlusion>{}</occlusion><occlusion_kf>0</occlusion_kf>"
          "<truncation>{}</truncation></item>",
          kCarAt - x, k == 2 ? -1 : k, k == 1 ? 1 : 0);
    }
    write("day/drive/oxts/timestamps.txt", times);
    write("day/drive/velodyne_points/timestamps.txt", times);
    write("day/drive/tracklet_labels.xml",
          "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\" ?>\n<!DOCTYPE "
          "boost_serialization>\n<boost_serialization signature=\"serialization::archive\" "
          "version=\"9\"><tracklets class_id=\"0\"><count>1</count><item_version>1</item_version>"
          "<item><objectType>Car</objectType><h>1.5</h><w>1.6</w><l>4</l><first_frame>0"
          "</first_frame><poses><count>3</count><item_version>2</item_version>" +
              boxes + "</poses><finished>1</finished></item></tracklets></boost_serialization>\n");
  }
  std::vector<std::string> drive() const { return {"--dir", file("day/drive")}; }
};

TEST_F(KittiRawImport, ScansHaveTheirStampsAndTheVehiclesPoses) {
  ASSERT_EQ(import("kitti-raw", drive()), 0) << error_;
  const auto scans = framesOf("LIDAR_TOP");
  ASSERT_EQ(scans.size(), 3U);
  EXPECT_EQ(scans[1].stamp.ns - scans[0].stamp.ns, 100'000'000);
  EXPECT_NEAR(scans[0].stamp.seconds(), 1317042145.1, 1e-3);  // 2011-09-26 13:02:25.1
  EXPECT_NEAR(scans[2].ego.T_world_ego.translation().x(), kEastward * 0.2, 1e-3);
  EXPECT_EQ(std::get<LidarCloud>(scans[0].data).size(), 3U);
  EXPECT_EQ(frameNumbers(), (std::vector<std::int64_t>{0, 1, 2}));
}

TEST_F(KittiRawImport, TrackletsAreTheTruth) {
  ASSERT_EQ(import("kitti-raw", drive()), 0) << error_;
  const GroundTruth truth = readGroundTruth(file("out.truth.csv"));
  ASSERT_EQ(truth.instants.size(), 3U);
  const TruthObject& car = truth.instants[1].objects.at(0);
  EXPECT_EQ(car.type, "Car");
  EXPECT_TRUE(car.position.isApprox(Vector3(kCarAt, 0, 0.03), 1e-3)) << car.position.transpose();
  EXPECT_NEAR(car.yaw, 0.1, 1e-4);
  EXPECT_EQ(car.length, 4);
  EXPECT_NEAR(car.vx, 0, 1e-2) << "it stands";
  EXPECT_EQ(car.occluded, 1);
  EXPECT_EQ(car.truncated, 0.5);
  EXPECT_EQ(car.lidar_points, 2);
  EXPECT_EQ(truth.instants[2].objects.at(0).occluded, 3) << "not set";
}

TEST_F(KittiRawImport, AScanThatIsMissingKeepsTheStampsOfTheOthers) {
  std::filesystem::remove(file("day/drive/velodyne_points/data/0000000001.bin"));
  ASSERT_EQ(import("kitti-raw", drive()), 0) << error_;
  const auto scans = framesOf("LIDAR_TOP");
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[1].stamp.ns - scans[0].stamp.ns, 200'000'000);
}

TEST_F(KittiRawImport, WithoutTrackletsThereIsNoTruthAndItIsSaid) {
  std::filesystem::remove(file("day/drive/tracklet_labels.xml"));
  ASSERT_EQ(import("kitti-raw", drive()), 0) << error_;
  EXPECT_FALSE(std::filesystem::exists(file("out.truth.csv")));
  EXPECT_EQ(result_.notes.at(0), "no tracklet_labels.xml: no truth");
}

TEST_F(KittiRawImport, WhatIsDamagedIsNamedWithItsPlace) {
  write("day/drive/velodyne_points/timestamps.txt", "2011-09-26 13:02:25.1\nnever\n");
  expectFault(65, "timestamps.txt:2: expected 2011-09-26", "kitti-raw", drive());
  SetUp();
  write("day/drive/oxts/data/0000000001.txt", "0 0\n");
  expectFault(65, "0000000001.txt:1", "kitti-raw", drive());
  SetUp();
  write("day/drive/tracklet_labels.xml",
        "<boost_serialization><tracklets><item><objectType>Car</objectType><h>high</h></item>"
        "</tracklets></boost_serialization>");
  expectFault(65, "tracklet_labels.xml:1: h: expected a number", "kitti-raw", drive());
  SetUp();
  std::filesystem::remove(file("day/calib_imu_to_velo.txt"));
  expectFault(66, "calib_imu_to_velo.txt", "kitti-raw", drive());
}

}  // namespace
}  // namespace perception
