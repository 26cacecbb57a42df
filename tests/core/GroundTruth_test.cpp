#include "libperception/core/GroundTruth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "libperception/core/Error.h"

namespace perception {
namespace {

constexpr const char* kHeader =
    "frame,t,id,class,x,y,z,yaw,length,width,height,vx,vy,truncated,occluded,lidar_points,ignore\n";

class GroundTruthFile : public testing::Test {
 protected:
  void SetUp() override {
    path_ = testing::TempDir() + "truth_" +
            testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv";
  }
  void TearDown() override { std::filesystem::remove(path_); }
  GroundTruth read(const std::string& rows) {
    std::ofstream(path_) << kHeader << rows;
    return readGroundTruth(path_);
  }
  std::string messageOf(const std::string& rows) {
    try {
      read(rows);
    } catch (const DataError& error) {
      return error.what();
    }
    return "";
  }
  std::string path_;
};

TEST_F(GroundTruthFile, GroupsRowsByInstantInOrderOfTime) {
  const GroundTruth truth = read(
      "1,0.1,4,Car,1,2,0,0.5,4,2,1.5,,,0,0,30,0\n"
      "0,0,4,Car,0,2,0,0.5,4,2,1.5,10,0,0,0,30,0\n"
      "0,0,7,Pedestrian,5,1,0,,0.8,0.6,1.8,,,0,1,,0\n");
  ASSERT_EQ(truth.instants.size(), 2u);
  EXPECT_EQ(truth.instants[0].frame, 0);
  ASSERT_EQ(truth.instants[0].objects.size(), 2u);
  EXPECT_EQ(truth.instants[0].objects[0].vx, 10);
  EXPECT_TRUE(std::isnan(truth.instants[0].objects[1].yaw));
  EXPECT_EQ(truth.instants[0].objects[1].lidar_points, -1);
  EXPECT_TRUE(std::isnan(truth.instants[1].objects[0].vx));
}

TEST_F(GroundTruthFile, OnlyIgnoredRowsMayLackTheirPlace) {
  EXPECT_TRUE(
      std::isnan(read("0,0,,DontCare,,,,,,,,,,,,,1\n").instants[0].objects[0].position.x()));
  EXPECT_NE(
      messageOf("0,0,1,Car,,,,,,,,,,,,,0\n").find(":2: column 'x': found '', expected a number"),
      std::string::npos);
}

TEST_F(GroundTruthFile, FaultsNameLineAndColumn) {
  EXPECT_NE(messageOf("0,0,1,Car,1,1,0,0,-4,2,1,,,0,0,5,0\n").find(":2: column 'length'"),
            std::string::npos);
  EXPECT_NE(messageOf("0,0,1,Car,1,1,0,0,4,2,1,,,0,0,5,0\n0,0,1,Car,1,1,0,0,4,2,1,,,0,0,5,0\n")
                .find(":3: column 'id'"),
            std::string::npos);
  EXPECT_NE(messageOf("0,0,1,Car,1,1,0,0,4,2,1,,,0,0,5,0\n0,0.1,1,Car,1,1,0,0,4,2,1,,,0,0,5,0\n")
                .find(":3: column 'frame'"),
            std::string::npos);
  EXPECT_NE(messageOf("0,0,1,,1,1,0,0,4,2,1,,,0,0,5,0\n").find("column 'class'"),
            std::string::npos);
}

TEST_F(GroundTruthFile, AreasOfTheImageHaveColumnsOfTheirOwn) {
  TruthObject area, car;
  area.type = "DontCare";
  area.ignore = true;
  area.area = ImageArea{10, 20, 30.5, 40};
  car.type = "Car";
  writeGroundTruth(path_, {area, car});
  const auto objects = readGroundTruth(path_).instants.at(0).objects;
  ASSERT_TRUE(objects[0].area);
  EXPECT_EQ(objects[0].area->right, 30.5);
  EXPECT_FALSE(objects[1].area);
}

TEST_F(GroundTruthFile, WhatIsWrittenIsReadBack) {
  TruthObject car;
  car.frame = 12;
  car.t = 1.2;
  car.id = 3;
  car.type = "Van";
  car.position = {-1.25, 2.5, -0.00001};
  car.yaw = -3.1;
  car.length = 4;
  car.width = 1.9;
  car.height = 2;
  car.vx = 5;
  car.vy = -0.5;
  car.truncated = 0.25;
  car.occluded = 2;
  car.lidar_points = 17;
  TruthObject area;
  area.frame = 12;
  area.t = 1.2;
  area.type = "DontCare";
  area.position.setConstant(std::nan(""));
  area.ignore = true;
  writeGroundTruth(path_, {car, area});
  const GroundTruth truth = readGroundTruth(path_);
  ASSERT_EQ(truth.instants.size(), 1u);
  EXPECT_EQ(truth.instants[0].t, 1.2);
  ASSERT_EQ(truth.instants[0].objects.size(), 2u);
  const TruthObject& back = truth.instants[0].objects[0];
  EXPECT_EQ(back.type, "Van");
  EXPECT_EQ(back.position, Vector3(-1.25, 2.5, 0));
  EXPECT_EQ(back.yaw, -3.1);
  EXPECT_EQ(back.vy, -0.5);
  EXPECT_EQ(back.truncated, 0.25);
  EXPECT_EQ(back.occluded, 2);
  EXPECT_EQ(back.lidar_points, 17);
  EXPECT_EQ(back.id, 3);
  EXPECT_TRUE(truth.instants[0].objects[1].ignore);
  EXPECT_EQ(truth.instants[0].objects[1].id, -1);
}

TEST_F(GroundTruthFile, AFileThatCannotBeCreatedOrReadIsSaid) {
  EXPECT_THROW(writeGroundTruth("/nowhere/at/all.csv", {}), OutputError);
  EXPECT_THROW(readGroundTruth("/nowhere/at/all.csv"), DataError);
  std::ofstream(path_) << "frame,t\n";
  EXPECT_THROW(readGroundTruth(path_), DataError);
}

TEST_F(GroundTruthFile, StandsBesideItsLog) {
  EXPECT_EQ(truthFileOf("a.b/c.d.rawlog"), "a.b/c.d.truth.csv");
  EXPECT_EQ(truthFileOf("a.b/c.d"), "a.b/c.d.truth.csv");
  EXPECT_EQ(labelFolderOf("a/b.rawlog"), "a/b_Labels");
  const std::string beside = truthFileOf(path_ + ".rawlog");
  TruthObject car;
  car.type = "Car";
  writeGroundTruth(beside, {car});
  EXPECT_EQ(truthBeside(path_ + ".rawlog").instants.size(), 1u);
  std::filesystem::remove(beside);
  EXPECT_THROW(truthBeside(path_ + ".rawlog"), DataError);
}

TEST_F(GroundTruthFile, ATruthWithoutObjectsIsReadAsEmpty) {
  writeGroundTruth(path_, {});
  EXPECT_TRUE(readGroundTruth(path_).instants.empty());
}

}  // namespace
}  // namespace perception
