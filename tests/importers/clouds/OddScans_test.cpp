// Folders of scans: in the frame of the poses, in whole numbers, with times that begin anywhere.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/importers/clouds/ImportClouds.h"
#include "libperception/importers/kitti/KittiFiles.h"
#include "tests/importers/OddRecording.h"

namespace perception {
namespace {

using namespace test;

constexpr int kFiles = 12;

std::string rowsOf(const LidarCloud& cloud) {
  std::string bytes;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    for (const float v : {cloud.x[i], cloud.y[i], cloud.z[i], cloud.intensity[i]})
      bytes.append(reinterpret_cast<const char*>(&v), sizeof(v));
  return bytes;
}

std::string pcdOf(const LidarCloud& cloud, const std::string& viewpoint = "0 0 0 1 0 0 0") {
  return fmt::format(
             "VERSION .7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n"
             "WIDTH {0}\nHEIGHT 1\nVIEWPOINT {1}\nPOINTS {0}\nDATA binary\n",
             cloud.size(), viewpoint) +
         rowsOf(cloud);
}

/// A line of 12 numbers, or of all 16.
std::string lineOf(const Pose3& T, bool whole = false) {
  std::string line;
  for (int r = 0; r < (whole ? 4 : 3); ++r)
    for (int c = 0; c < 4; ++c) line += fmt::format("{:.9g} ", T.matrix()(r, c));
  return line + "\n";
}

class OddScans : public OddRecording {
 protected:
  static Pose3 placeOf(int k, double origin) {
    return makePose(origin + 10 * k, 0.5 * k, 0.1, 0.05 * k);
  }
  std::string posesOf(double origin, bool whole = false) const {
    std::string poses;
    for (int k = 0; k < kFiles; ++k) poses += lineOf(placeOf(k, origin), whole);
    return poses;
  }
  int importScans(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"--clouds", file("clouds"), "--rate", "1"};
    words.insert(words.end(), more.begin(), more.end());
    return import("clouds", words);
  }
  void expectTurns(const std::vector<SensorFrame>& frames) {
    ASSERT_EQ(frames.size(), static_cast<std::size_t>(kFiles));
    for (int k = 0; k < kFiles; ++k) {
      const auto& got = std::get<LidarCloud>(frames[static_cast<std::size_t>(k)].data);
      const LidarCloud expected = oneTurn(k);
      for (std::size_t i = 0; i < got.size(); i += 11) {
        EXPECT_NEAR(got.x[i], expected.x[i], 0.01);
        EXPECT_NEAR(got.y[i], expected.y[i], 0.01);
        EXPECT_NEAR(got.z[i], expected.z[i], 0.01);
      }
    }
  }
};

TEST_F(OddScans, InTheFrameOfThePosesAreMovedBackToTheLidar) {
  for (const double origin : {0.0, 5000.0}) {
    for (int k = 0; k < kFiles; ++k)
      write(fmt::format("clouds/{:02}.pcd", k), pcdOf(inFrame(oneTurn(k), placeOf(k, origin))));
    write("poses.txt", posesOf(origin));
    ASSERT_EQ(importScans({"--poses", file("poses.txt")}), 0) << error_;
    expectSaid("the returns lie about the places of the poses");
    const auto frames = framesOf("LIDAR_TOP");
    expectTurns(frames);
    EXPECT_NEAR(frames[11].ego.T_world_ego.translation().head<2>().norm(), 110, 0.5);
  }
}

TEST_F(OddScans, InTheFrameOfTheVehiclesPosesToo) {
  const Pose3 T_ego_lidar = makePose(1, 0, 2, radians(90));
  for (int k = 0; k < kFiles; ++k)
    write(fmt::format("clouds/{:02}.pcd", k),
          pcdOf(inFrame(oneTurn(k), placeOf(k, 0) * T_ego_lidar)));
  write("poses.txt", posesOf(0));
  ASSERT_EQ(importScans({"--poses", file("poses.txt"), "--poses-frame", "ego", "--lidar-pose", "1",
                         "0", "2", "90", "0", "0"}),
            0)
      << error_;
  expectTurns(framesOf("LIDAR_TOP"));
}

TEST_F(OddScans, InTheLidarsFrameStayWhereTheyAre) {
  for (int k = 0; k < kFiles; ++k) write(fmt::format("clouds/{:02}.pcd", k), pcdOf(oneTurn(k)));
  write("poses.txt", posesOf(0));
  ASSERT_EQ(importScans({"--poses", file("poses.txt")}), 0) << error_;
  for (const std::string& note : result_.notes)
    EXPECT_EQ(note.find("moved back"), std::string::npos) << note;
  expectTurns(framesOf("LIDAR_TOP"));
}

TEST_F(OddScans, InAMapFarAwayAreRefused) {
  for (const double origin : {450000.0, 5.4e6}) {
    for (int k = 0; k < kFiles; ++k)
      write(fmt::format("clouds/{:02}.pcd", k), pcdOf(inFrame(oneTurn(k), placeOf(k, origin))));
    write("poses.txt", posesOf(origin));
    expectFault(65, "where float32 is too coarse", "clouds",
                {"--clouds", file("clouds"), "--poses", file("poses.txt")});
    expectFault(65, "LIDAR_TOP: most returns of 12 of 12 scans lie farther than 1000 m", "clouds",
                {"--clouds", file("clouds")});
  }
}

TEST_F(OddScans, ViewpointsBesidePosesAreSaidToBeUnused) {
  for (int k = 0; k < kFiles; ++k)
    write(fmt::format("clouds/{:02}.pcd", k), pcdOf(oneTurn(k), "0 0 1.8 1 0 0 0"));
  write("poses.txt", posesOf(0));
  ASSERT_EQ(importScans({"--poses", file("poses.txt")}), 0) << error_;
  expectSaid("the VIEWPOINT of " + file("clouds/11.pcd") + " is not used");
}

TEST_F(OddScans, PosesMayBeWholeMatrices) {
  for (int k = 0; k < kFiles; ++k) write(fmt::format("clouds/{:02}.pcd", k), pcdOf(oneTurn(k)));
  write("poses.txt", posesOf(0, true));
  ASSERT_EQ(importScans({"--poses", file("poses.txt")}), 0) << error_;
  EXPECT_NEAR(framesOf("LIDAR_TOP")[2].ego.T_world_ego.translation().head<2>().norm(), 20.02, 0.1);
  std::filesystem::remove(file("out.rawlog"));
  std::string other = posesOf(0, true);
  other.replace(other.find(" 1 \n"), 4, " 2 \n");
  write("poses.txt", other);
  expectFault(65, "poses.txt:1: 16 fields, expected 12", "clouds",
              {"--clouds", file("clouds"), "--poses", file("poses.txt")});
}

/// Columns x, y, z of int16, in centimeters.
std::string wholeNumbersOf(const LidarCloud& cloud) {
  std::string bytes;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (const float v : {cloud.x[i], cloud.y[i], cloud.z[i]}) {
      const auto whole = static_cast<std::int16_t>(std::lround(100 * v));
      bytes.append(reinterpret_cast<const char*>(&whole), sizeof(whole));
    }
  }
  return bytes;
}

TEST_F(OddScans, CoordinatesInWholeNumbersHaveNoUnitAndAreRefused) {
  const std::string data = wholeNumbersOf(oneTurn(0));
  const std::string words = "x, y and z are whole numbers, whose unit is not said";
  write("clouds/0.pcd",
        "FIELDS x y z\nSIZE 2 2 2\nTYPE I I I\nCOUNT 1 1 1\nWIDTH 720\nHEIGHT 1\nPOINTS 720\n"
        "DATA binary\n" +
            data);
  expectFault(65, words, "clouds", {"--clouds", file("clouds")});
  std::filesystem::remove(file("clouds/0.pcd"));
  write("clouds/0.ply",
        "ply\nformat binary_little_endian 1.0\nelement vertex 720\nproperty short x\n"
        "property short y\nproperty short z\nend_header\n" +
            data);
  expectFault(65, words, "clouds", {"--clouds", file("clouds")});
  std::filesystem::remove(file("clouds/0.ply"));
  std::string head = "{'descr': '<i2', 'fortran_order': False, 'shape': (720, 3), }";
  head.resize(117, ' ');
  head += '\n';
  write("clouds/0.npy", std::string("\x93NUMPY\1\0\x76\0", 10) + head + data);
  expectFault(65, words, "clouds", {"--clouds", file("clouds"), "--columns", "x,y,z"});
}

TEST_F(OddScans, BinariesOfTheOtherByteOrderAreRefused) {
  std::string bytes = rowsOf(oneTurn(0));
  for (std::size_t i = 0; i < bytes.size(); i += 4)
    std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                 bytes.begin() + static_cast<std::ptrdiff_t>(i + 4));
  write("clouds/0.bin", bytes);
  EXPECT_EQ(importScans(), 65) << error_;
}

/// A table of some returns with times.
std::string tableOf(const std::function<std::string(int)>& row) {
  std::string text = "x,y,z,intensity,time\n";
  for (int i = 0; i < 200; ++i) text += row(i) + "\n";
  return text;
}

TEST_F(OddScans, TimesAreAfterTheEarliestReturnWhereverItIs) {
  const auto returnAt = [](int i, double time) {
    return fmt::format("{:.3f},{:.3f},-1,0.5,{:.6f}", 10 + 0.01 * i, 1.0 * (i % 7), time);
  };
  const std::pair<const char*, std::string> tables[] = {
      {"ring after ring, each from 50 ms on",
       tableOf([&](int i) { return returnAt(i, 5 + 0.0005 * ((i + 100) % 200)); })},
      {"latest first", tableOf([&](int i) { return returnAt(i, 5 + 0.0005 * (199 - i)); })},
      {"no return first", tableOf([&](int i) {
         return i < 3 ? "nan,nan,nan,0,0" : i < 6 ? "0,0,0,0,0" : returnAt(i, 5 + 0.0005 * (i - 6));
       })}};
  for (const auto& [what, table] : tables) {
    write("clouds/0.csv", table);
    ASSERT_EQ(importScans(), 0) << what << error_;
    const auto frames = framesOf("LIDAR_TOP");
    ASSERT_EQ(frames.size(), 1U);
    const auto& cloud = std::get<LidarCloud>(frames[0].data);
    ASSERT_GE(cloud.time_offset.size(), 194U) << what;
    float least = 1, most = -1;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      least = std::min(least, cloud.time_offset[i]), most = std::max(most, cloud.time_offset[i]);
    EXPECT_NEAR(least, 0, 1e-6) << what;
    EXPECT_GT(most, 0.09) << what;
  }
}

TEST_F(OddScans, TablesInMillimetersWithoutAUnitAreRefused) {
  writeClouds(".csv", [](const LidarCloud& cloud) {
    std::string text = "x,y,z\n";
    for (std::size_t i = 0; i < cloud.size(); ++i)
      text += fmt::format("{:.0f},{:.0f},{:.0f}\n", 1000 * cloud.x[i], 1000 * cloud.y[i],
                          1000 * cloud.z[i]);
    return text;
  });
  expectFault(65, "their coordinates are not in meters", "clouds", {"--clouds", file("clouds")});
}

TEST_F(OddScans, AnArchiveIsSaidToBeOne) {
  write("clouds.zip", "PK\3\4");
  expectFault(65, "clouds.zip: not a folder; .zip is an archive: unpack it", "clouds",
              {"--clouds", file("clouds.zip")});
}

TEST_F(OddScans, AnglesInDegreesWhereRadiansAreDueAreRefused) {
  write("oxts.txt", "49.0 8.4 110 0.5 -1.2 123.4\n");
  try {
    readKittiOxts(file("oxts.txt"));
    FAIL();
  } catch (const DataError& e) {
    EXPECT_NE(std::string(e.what()).find("field 6: found '123.4', expected an angle in radians"),
              std::string::npos)
        << e.what();
  }
}

}  // namespace
}  // namespace perception
