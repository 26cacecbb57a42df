#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libperception/core/Error.h"
#include "libperception/importers/clouds/ImportClouds.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

/// Two points (1, 2, 3; intensity .5) and (-4, 5.5, 6; .25) in every format.
class CloudFiles : public test::ImportRun {
 protected:
  const std::vector<float> rows_{1, 2, 3, .5F, -4, 5.5F, 6, .25F};
  const std::vector<float> columns_{1, -4, 2, 5.5F, 3, 6, .5F, .25F};

  static std::string pcd(const std::string& data) {
    return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\n"
           "COUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA " +
           data + "\n";
  }
  static std::string ply(const std::string& format) {
    return "ply\nformat " + format +
           " 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
           "property float intensity\nend_header\n";
  }
  std::string packed() const {
    const std::string raw = bytesOf(columns_);
    // One literal run of LZF: its length - 1, then 32 bytes as they are.
    const std::string out = std::string(1, static_cast<char>(raw.size() - 1)) + raw;
    return bytesOf<std::uint32_t>(
               {static_cast<std::uint32_t>(out.size()), static_cast<std::uint32_t>(raw.size())}) +
           out;
  }
  std::string swapped() const {
    std::string bytes = bytesOf(rows_);
    for (std::size_t i = 0; i < bytes.size(); i += 4)
      std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                   bytes.begin() + static_cast<std::ptrdiff_t>(i + 4));
    return bytes;
  }
  std::string faultOf(const std::string& name, const CloudFormat& format = {}) const {
    try {
      readCloudFile(file(name), format);
    } catch (const DataError& e) {
      return e.what();
    }
    return "no fault";
  }
};

TEST_F(CloudFiles, EveryFormatGivesTheSamePoints) {
  const std::string text = "1 2 3 0.5\n-4 5.5 6 0.25\n";
  write("excel.csv", "\xef\xbb\xbfx;y;z;intensity\r\n1;2;3;0,5\r\n-4;5,5;6;0,25\r\n");
  write("a.bin", bytesOf(rows_));
  writeGz("b.bin.gz", bytesOf(rows_));
  write("c.pcd", pcd("ascii") + text);
  write("d.pcd", pcd("binary") + bytesOf(rows_));
  write("e.pcd", pcd("binary_compressed") + packed());
  write("f.ply", ply("ascii") + text);
  write("g.ply", ply("binary_little_endian") + bytesOf(rows_));
  write("h.ply", ply("binary_big_endian") + swapped());
  write("i.csv", "X;Y;Z;Intensity\n1;2;3;0.5\n\n-4;5.5;6;0.25\n");
  write("j.xyz", text);
  writeGz("k.txt.gz", "1,2,3,0.5\r\n-4,5.5,6,0.25\r\n");
  int formats = 0;
  for (const auto& entry : fs::directory_iterator(folder_.path())) {
    const LidarCloud cloud = readCloudFile(entry.path().string());
    ASSERT_EQ(cloud.size(), 2u) << entry.path();
    EXPECT_EQ(cloud.x, (std::vector<float>{1, -4})) << entry.path();
    EXPECT_EQ(cloud.y, (std::vector<float>{2, 5.5F})) << entry.path();
    EXPECT_EQ(cloud.z, (std::vector<float>{3, 6})) << entry.path();
    EXPECT_EQ(cloud.intensity, (std::vector<float>{.5F, .25F})) << entry.path();
    ++formats;
  }
  EXPECT_EQ(formats, 12);
}

TEST_F(CloudFiles, RingsTimesAndStrangeColumnsAreUnderstood) {
  CloudFormat format;
  format.columns = {"x", "y", "z", "ring", "garbage", "time"};
  format.time_scale = 1e-6;
  write("a.bin", bytesOf<float>({1, 2, 3, 7, 99, 500, 4, 5, 6, 8, 99, 1500}));
  const LidarCloud cloud = readCloudFile(file("a.bin"), format);
  EXPECT_EQ(cloud.ring, (std::vector<std::uint16_t>{7, 8}));
  ASSERT_EQ(cloud.time_offset.size(), 2u);
  EXPECT_EQ(cloud.time_offset[0], 0);
  EXPECT_NEAR(cloud.time_offset[1], 1e-3, 1e-9);
  EXPECT_TRUE(cloud.intensity.empty());
}

TEST_F(CloudFiles, PointsThatAreNoNumbersKeepTheirPlace) {
  write("a.pcd", pcd("ascii") + "nan nan nan 0\n-4 5.5 6 0.25\n");
  const LidarCloud cloud = readCloudFile(file("a.pcd"));
  ASSERT_EQ(cloud.size(), 2u);
  EXPECT_TRUE(std::isnan(cloud.x[0]));
  EXPECT_EQ(cloud.x[1], -4);
}

TEST_F(CloudFiles, FaultsNameFileAndPlace) {
  write("cut.bin", bytesOf<float>({1, 2, 3}));
  EXPECT_NE(faultOf("cut.bin").find("cut.bin: 12 bytes, expected 16 a point"), std::string::npos);
  write("cut.pcd", pcd("binary") + bytesOf<float>({1, 2, 3}));
  EXPECT_NE(faultOf("cut.pcd").find("12 bytes of points, expected 32"), std::string::npos);
  write("short.pcd", pcd("ascii") + "1 2 3 0.5\n");
  EXPECT_NE(faultOf("short.pcd").find("ends after 1 of 2 points"), std::string::npos);
  write("word.pcd", pcd("ascii") + "1 2 3 0.5\n1 two 3 0\n");
  EXPECT_NE(faultOf("word.pcd").find("word.pcd:13: field 2: found 'two'"), std::string::npos);
  write("packed.pcd", pcd("binary_compressed") + bytesOf<std::uint32_t>({4, 32}) +
                          "\x1f"
                          "abc");
  EXPECT_NE(faultOf("packed.pcd").find("damaged LZF data"), std::string::npos);
  write("size.pcd", pcd("binary_compressed") + bytesOf<std::uint32_t>({4, 99}) + "abcd");
  EXPECT_NE(faultOf("size.pcd").find("99 bytes of points after unpacking, expected 32"),
            std::string::npos);
  write("strange.pcd", pcd("ternary"));
  EXPECT_NE(faultOf("strange.pcd").find("DATA ternary, expected ascii"), std::string::npos);
  write("huge.pcd", "FIELDS x\nSIZE 4\nTYPE F\nCOUNT 1\nPOINTS 999999999\nDATA binary\n");
  EXPECT_NE(faultOf("huge.pcd").find("999999999 points, expected at most"), std::string::npos);
  // No memory for what the rest of the file cannot hold.
  for (const char* data : {"ascii", "binary", "binary_compressed"}) {
    write("promise.pcd", std::string("FIELDS x\nSIZE 4\nTYPE F\nCOUNT 1\nPOINTS 16000000\nDATA ") +
                             data + "\n1\n2\n");
    EXPECT_NE(faultOf("promise.pcd").find("16000000 points in 4 bytes: the file was cut"),
              std::string::npos)
        << data;
  }
  write("wide.pcd", "FIELDS x y\nSIZE 4\n");
  EXPECT_NE(faultOf("wide.pcd").find("wide.pcd:2:"), std::string::npos);
  write("type.pcd", "FIELDS x y z\nSIZE 3 4 4\nTYPE F F F\nCOUNT 1 1 1\nPOINTS 0\nDATA ascii\n");
  EXPECT_NE(faultOf("type.pcd").find("TYPE F of SIZE 3"), std::string::npos);
  write("none.pcd", "hello\n");
  EXPECT_NE(faultOf("none.pcd").find("expected a PCD file"), std::string::npos);
  write("none.ply", "hello\n");
  EXPECT_NE(faultOf("none.ply").find("expected a PLY file"), std::string::npos);
  write("list.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int x\n");
  EXPECT_NE(faultOf("list.ply").find("list.ply:4:"), std::string::npos);
  write("names.csv", "a,b,c\n1,2,3\n");
  EXPECT_NE(faultOf("names.csv").find("columns a, b, c: expected x, y and z"), std::string::npos);
  write("bad.bin.gz", "\x1f\x8b\x08 this is no gzip data");
  EXPECT_NE(faultOf("bad.bin.gz").find("bad or cut gzip data"), std::string::npos);
  try {
    readCloudFile(file("nowhere.bin"));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::kNoInput);
  }
}

/// `perception-import clouds`: three scans of one point.
class CloudsImport : public CloudFiles {
 protected:
  void SetUp() override {
    for (const char* name : {"clouds/10.bin", "clouds/11.bin", "clouds/13.bin"})
      write(name, bytesOf<float>({5, 0, -1, 128}));
  }
  std::vector<std::string> with(std::vector<std::string> more) const {
    more.insert(more.end(), {"--clouds", file("clouds"), "--intensity-max", "256", "--columns",
                             "x,y,z,intensity"});
    return more;
  }
};

TEST_F(CloudsImport, NumbersOfTheFilesAreFrameNumbersAndTimes) {
  ASSERT_EQ(import("clouds", with({"--rate", "4", "--lidar-pose", "1", "0", "2", "90", "0", "0"})),
            0)
      << error_;
  EXPECT_EQ(frameNumbers(), (std::vector<std::int64_t>{10, 11, 13}));
  const auto frames = framesOf("LIDAR_TOP");
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_NEAR(frames[2].stamp - frames[0].stamp, 0.75, 1e-6);
  EXPECT_EQ(std::get<LidarCloud>(frames[0].data).intensity[0], 0.5F);
  EXPECT_TRUE((frames[0].T_ego_sensor * Vector3(5, 0, -1)).isApprox(Vector3(1, 5, 1), 1e-6));
}

TEST_F(CloudsImport, PosesOfTheLidarBecomeTheVehicles) {
  // The lidar goes 2 m ahead, turns left, goes 2 m ahead.
  write("poses.txt",
        "1 0 0 7 0 1 0 0 0 0 1 0\n0 -1 0 9 1 0 0 0 0 0 1 0\n0 -1 0 9 1 0 0 2 0 0 1 0\n");
  ASSERT_EQ(import("clouds", with({"--poses", file("poses.txt")})), 0) << error_;
  EXPECT_EQ(result_.notes,
            std::vector<std::string>{"no --stamps: taken as 10 scans a second (--rate)"});
  const auto frames = framesOf("LIDAR_TOP");
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_TRUE(frames[0].ego.T_world_ego.isApprox(Pose3::Identity(), 1e-9));
  EXPECT_TRUE(frames[2].ego.T_world_ego.isApprox(makePose(2, 2, 0, kPi / 2), 1e-6));
}

/// 12 x 12 returns of a slope, with rings, in rows of five numbers.
std::vector<float> fiveColumns() {
  std::vector<float> numbers;
  for (int k = 0; k < 12; ++k) {
    for (int ring = 0; ring < 12; ++ring) {
      const auto range = static_cast<float>(5 + ring), side = static_cast<float>(k * 5 % 12 - 6);
      for (const float v : {range, side, 0.2F * range - 3, static_cast<float>(20 * (k % 9)),
                            static_cast<float>(ring)})
        numbers.push_back(v);
    }
  }
  return numbers;
}

TEST_F(CloudsImport, ColumnsAreFoundFromTheDataAndSaid) {
  for (const char* name : {"clouds/10.bin", "clouds/11.bin", "clouds/13.bin"})
    write(name, bytesOf(fiveColumns()));
  ASSERT_EQ(import("clouds", {"--clouds", file("clouds")}), 0) << error_;
  EXPECT_NE(result_.notes.back().find(
                "columns found from the data: x y z intensity ring, intensity up to 255"),
            std::string::npos)
      << result_.notes.back();
  const auto frames = framesOf("LIDAR_TOP");
  ASSERT_EQ(frames.size(), 3u);
  const auto& cloud = std::get<LidarCloud>(frames[0].data);
  ASSERT_EQ(cloud.size(), 144u);
  EXPECT_EQ(cloud.x[143], 16);
  EXPECT_EQ(cloud.ring[143], 11);
  EXPECT_NEAR(static_cast<double>(cloud.intensity[12]), 20 / 255., 0.005);
}

TEST_F(CloudsImport, SmallScansTellTheirColumnsTogetherOrAreRefused) {
  const std::vector<float> all = fiveColumns();
  for (std::size_t k = 0; k < 3; ++k) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(k * 48 * 5);
    write("small/" + std::to_string(k) + ".bin", bytesOf<float>({begin, begin + 48 * 5}));
  }
  ASSERT_EQ(import("clouds", {"--clouds", file("small")}), 0) << error_;
  EXPECT_EQ(std::get<LidarCloud>(framesOf("LIDAR_TOP")[2].data).size(), 48u);
  std::filesystem::remove(file("out.rawlog"));
  std::filesystem::remove(file("small/1.bin"));
  std::filesystem::remove(file("small/2.bin"));
  expectFault(65, "0.bin: its 240 numbers do not tell how many columns it has; say them: --columns",
              "clouds", {"--clouds", file("small")});
}

TEST_F(CloudsImport, AFileThatDoesNotEndWithARowIsRefused) {
  for (const char* name : {"clouds/10.bin", "clouds/11.bin", "clouds/13.bin"})
    write(name, bytesOf(fiveColumns()) + std::string(3, '\0'));
  expectFault(65,
              "10.bin: 2883 bytes, expected 20 a point (5 float32): 3 are left from byte 2880 on",
              "clouds", {"--clouds", file("clouds")});
}

TEST_F(CloudsImport, StampedPosesAreInterpolatedAndTheirLackIsSaid) {
  write("stamps.txt", "2020-01-01 00:00:00.00\n2020-01-01T00:00:01.00\n2020-01-01_00:00:09.5\n");
  write("tum.txt", "# t x y z q\n1577836800.5 0 0 0 0 0 0 1\n1577836801.5 8 0 0 0 0 0 1\n");
  ASSERT_EQ(import("clouds", with({"--stamps", file("stamps.txt"), "--poses", file("tum.txt"),
                                   "--poses-format", "tum", "--poses-frame", "ego"})),
            3)
      << error_;
  EXPECT_NE(error_.find("no pose for 2 of 3 frames"), std::string::npos) << error_;
  const auto frames = framesOf("LIDAR_TOP");
  EXPECT_NEAR(frames[1].ego.T_world_ego.translation().x(), 4, 1e-6);
  EXPECT_EQ(frames[2].stamp.ns - frames[0].stamp.ns, 9'500'000'000);
}

TEST_F(CloudsImport, FaultsNameFileAndLine) {
  write("stamps.txt", "1\n2\n");
  expectFault(65, "stamps.txt: 2 stamps, expected one for each of 3 clouds", "clouds",
              with({"--stamps", file("stamps.txt")}));
  write("stamps.txt", "1\n2\nx\n");
  expectFault(65, "stamps.txt:3: expected seconds", "clouds",
              with({"--stamps", file("stamps.txt")}));
  write("stamps.txt", "1\n1\n3\n");
  expectFault(65, "stamps.txt:2: not after the line before", "clouds",
              with({"--stamps", file("stamps.txt")}));
  write("poses.txt", "1 0 0 7 0 1 0 0 0 0 1 0\n");
  expectFault(65, "poses.txt: 1 poses, expected one for each of 3 clouds", "clouds",
              with({"--poses", file("poses.txt")}));
  write("tum.txt", "1 0 0 0 0 0 0 2\n");
  expectFault(65, "tum.txt:1: qx qy qz qw is no unit quaternion", "clouds",
              with({"--poses", file("tum.txt"), "--poses-format", "tum"}));
  expectFault(66, "poses", "clouds", with({"--poses", file("no_poses.txt")}));
  expectFault(66, "no such folder", "clouds", {"--clouds", file("nowhere")});
  fs::create_directories(file("empty"));
  expectFault(66, "no file that ends in", "clouds", {"--clouds", file("empty")});
  write("clouds/13.pcd", pcd("ascii") + "1 2 3 0\n1 2 3 0\n");
  expectFault(65, "two files of one frame", "clouds", with({}));
  expectFault(64, "--last is before --first", "clouds", with({"--first", "5", "--last", "4"}));
  expectFault(64, "--rate", "clouds", with({"--rate", "-2"}));
}

// Poses behind a long gap must not push out those of the frames that still wait to be tracked.
TEST_F(CloudsImport, FramesBeforeAGapKeepTheirPlace) {
  write("stamps.txt", "100\n100.1\n200\n");
  write("poses.txt",
        "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n1 0 0 300 0 1 0 0 0 0 1 0\n");
  ASSERT_EQ(import("clouds", with({"--stamps", file("stamps.txt"), "--poses", file("poses.txt")})),
            0)
      << error_;
  const std::vector<Scene> scenes = track("kitti.ini", "L");
  ASSERT_EQ(scenes.size(), 3u);
  const double places[] = {0, 1, 300};
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(scenes[i].ego.T_world_ego.translation().x(), places[i], 1e-6) << i;
}

}  // namespace
}  // namespace perception
