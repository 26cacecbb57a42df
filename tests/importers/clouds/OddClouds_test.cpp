// Folders of clouds: numbers of another size, times of other units, stamps that go back.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/importers/OddRecording.h"

namespace perception {
namespace {

using namespace test;

class OddClouds : public OddRecording {};

std::string doublesOf(const LidarCloud& cloud, double share) {
  std::vector<double> numbers;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    for (const float v : {cloud.x[i], cloud.y[i], cloud.z[i], cloud.intensity[i]})
      numbers.push_back(static_cast<double>(v) * (1 + share));
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)};
}

std::string floatsOf(const LidarCloud& cloud) {
  std::vector<float> numbers;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    numbers.insert(numbers.end(), {cloud.x[i], cloud.y[i], cloud.z[i], cloud.intensity[i]});
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float)};
}

TEST_F(OddClouds, BinariesOfDoublesAreReadAsDoublesAndItIsSaid) {
  writeClouds(".bin", [](const LidarCloud& cloud) { return doublesOf(cloud, 0); });
  expectClouds({}, 0);
  expectSaid("look like float64");
  expectSaid("columns found from the data: x y z intensity");
  std::filesystem::remove(file("out.rawlog"));
  expectClouds({"--columns", "x,y,z,intensity"}, 0);
  expectSaid("look like float64");
}

TEST_F(OddClouds, BinariesOfDoublesWithAllTheirDigitsToo) {
  writeClouds(".bin", [](const LidarCloud& cloud) { return doublesOf(cloud, 1e-12); });
  expectClouds({}, 0);
  expectSaid("look like float64");
}

TEST_F(OddClouds, BinariesOfFloatsAreNotTakenForDoubles) {
  writeClouds(".bin", &floatsOf);
  expectClouds({}, 0);
  for (const std::string& note : result_.notes) EXPECT_EQ(note.find("float64"), std::string::npos);
}

TEST_F(OddClouds, TextBesideScansIsNoScan) {
  const auto floats = [](const LidarCloud& cloud) {
    std::vector<float> numbers;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      numbers.insert(numbers.end(), {cloud.x[i], cloud.y[i], cloud.z[i], cloud.intensity[i]});
    return bytesOf(numbers);
  };
  const auto lines = [](const LidarCloud& cloud) {
    std::string text;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      text += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g}\n", cloud.x[i], cloud.y[i], cloud.z[i],
                          cloud.intensity[i]);
    return text;
  };
  for (const bool text : {false, true}) {
    std::filesystem::remove_all(file("clouds"));
    writeClouds(text ? ".txt" : ".bin",
                text ? std::function<std::string(const LidarCloud&)>(lines) : floats);
    write("clouds/README.txt", "scans of my car\n");
    write("clouds/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
    write("clouds/stamps.csv", "scan,seconds\n0,1\n");
    std::filesystem::remove(file("out.rawlog"));
    expectClouds({}, 0);
    expectSaid("no scans by their names: 3 files of " + file("clouds") + ", such as README.txt");
  }
}

TEST_F(OddClouds, BinariesOfWholeNumbersAreRefused) {
  writeClouds(".bin", [](const LidarCloud& cloud) {
    std::vector<std::int16_t> numbers;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      for (const float v : {cloud.x[i], cloud.y[i], cloud.z[i], cloud.intensity[i]})
        numbers.push_back(static_cast<std::int16_t>(std::lround(100 * v)));
    return bytesOf(numbers);
  });
  expectFault(65, "--columns", "clouds", {"--clouds", file("clouds")});
}

TEST_F(OddClouds, TablesWithTimesInNanosecondsAreReadWithoutThem) {
  writeClouds(".csv", [](const LidarCloud& cloud) {
    std::string text = "x,y,z,intensity,timestamp\n";
    for (std::size_t i = 0; i < cloud.size(); ++i)
      text += fmt::format("{},{},{},{},{}\n", cloud.x[i], cloud.y[i], cloud.z[i],
                          cloud.intensity[i], kBegin + static_cast<std::int64_t>(i) * 100'000);
    return text;
  });
  expectClouds({}, 3);
  expectSaid("LIDAR_TOP: returns lie more than 1.05 s outside of 3 of its scans");
  std::filesystem::remove(file("out.rawlog"));
  expectClouds({"--time-scale", "1e-9"}, 0);
}

TEST_F(OddClouds, StampsOfAFolderThatGoBackAreRefusedWithTheirLine) {
  writeClouds(".csv", [](const LidarCloud&) { return std::string("x,y,z\n1,2,3\n"); });
  write("stamps.txt", "100.0\n100.5\n100.1\n");
  expectFault(65, "stamps.txt:3: not after the line before", "clouds",
              {"--clouds", file("clouds"), "--stamps", file("stamps.txt")});
}

TEST_F(OddClouds, ElementsOfAPlyBeforeItsPointsArePassedOver) {
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    SCOPED_TRACE(format);
    const bool ascii = format[0] == 'a', big = format == std::string("binary_big_endian");
    std::filesystem::remove_all(file("clouds"));
    std::filesystem::remove(file("out.rawlog"));
    writeClouds(".ply", [&](const LidarCloud& cloud) {
      std::string text = fmt::format(
          "ply\nformat {} 1.0\nelement camera 2\nproperty list uchar short shape\nproperty float "
          "view\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty "
          "float intensity\nelement face 0\nproperty list uchar int vertex_index\nend_header\n",
          format, cloud.size());
      for (const int values : {0, 3}) {  // of a list
        if (ascii) {
          text += fmt::format("{}{} 0.5\n", values, values == 0 ? "" : " 7 8 9");
        } else {
          text += static_cast<char>(values);
          text += std::string(static_cast<std::size_t>(2 * values + 4), '\5');
        }
      }
      for (std::size_t i = 0; i < cloud.size(); ++i) {
        for (const float value : {cloud.x[i], cloud.y[i], cloud.z[i], cloud.intensity[i]}) {
          std::string bytes(reinterpret_cast<const char*>(&value), sizeof(value));
          if (big) std::reverse(bytes.begin(), bytes.end());
          text += ascii ? fmt::format("{:.9g} ", value) : bytes;
        }
        if (ascii) text += '\n';
      }
      return text;
    });
    expectClouds({}, 0);
  }
}

TEST_F(OddClouds, LinesOfPosesAreThoseOfTheFilesNumbersWhereFilesAreMissing) {
  for (const int k : {0, 1, 4}) write("clouds/" + std::to_string(k) + ".bin", floatsOf(oneTurn(k)));
  std::string poses;
  for (int k = 0; k < 6; ++k) poses += fmt::format("1 0 0 {} 0 1 0 0 0 0 1 0\n", 10 * k);
  write("poses.txt", poses);
  ASSERT_EQ(import("clouds", {"--clouds", file("clouds"), "--poses", file("poses.txt")}), 0)
      << error_;
  const auto frames = framesOf("LIDAR_TOP");
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_NEAR(frames[2].ego.T_world_ego.translation().x(), 40, 1e-6);
  expectSaid("2 files are missing: line k of stamps and poses is that of file k");
}

TEST_F(OddClouds, ViewpointsOfPcdFilesAreThePosesOfTheLidarWhereTheyAreAskedFor) {
  const auto scan = [this](int k, const std::string& viewpoint) {
    const LidarCloud cloud = oneTurn(k);
    write(fmt::format("clouds/{}.pcd", k),
          fmt::format("VERSION .7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\n"
                      "COUNT 1 1 1 1\nWIDTH {0}\nHEIGHT 1\n{1}POINTS {0}\nDATA binary\n",
                      cloud.size(), viewpoint) +
              floatsOf(cloud));
  };
  for (int k = 0; k < 3; ++k) scan(k, fmt::format("VIEWPOINT {} 5 2 0.8 0 0 0.6\n", 10 + 3 * k));
  ASSERT_EQ(import("clouds", {"--clouds", file("clouds")}), 0) << error_;
  expectSaid("the VIEWPOINT of " + file("clouds/2.pcd") + " is not used: --poses-format pcd");
  EXPECT_NEAR(framesOf("LIDAR_TOP")[2].ego.T_world_ego.translation().norm(), 0, 1e-6);

  std::filesystem::remove(file("out.rawlog"));
  const std::vector<std::string> asked{"--clouds", file("clouds"), "--poses-format", "pcd"};
  ASSERT_EQ(import("clouds", asked), 0) << error_;
  const auto frames = framesOf("LIDAR_TOP");
  ASSERT_EQ(frames.size(), 3U);
  const Vector3 driven = frames[2].ego.T_world_ego.translation();  // 6 m to the fixed frame's x
  EXPECT_NEAR(driven.x(), 6 * 0.28, 1e-5);
  EXPECT_NEAR(driven.y(), -6 * 0.96, 1e-5);

  std::filesystem::remove(file("out.rawlog"));
  expectFault(64, "leave out --poses", "clouds",
              {"--clouds", file("clouds"), "--poses-format", "pcd", "--poses", file("poses.txt")});
  for (const char* none : {"", "VIEWPOINT 0 0 0 0 0 0 0\n", "VIEWPOINT 1 2 three 1 0 0 0\n"}) {
    scan(1, none);
    expectFault(65, "clouds/1.pcd: no pose, expected VIEWPOINT", "clouds", asked);
    ASSERT_EQ(import("clouds", {"--clouds", file("clouds")}), 0) << error_;
    std::filesystem::remove(file("out.rawlog"));
  }
}

TEST_F(OddClouds, LinesThatEndAsOnOldMacintoshesAreRead) {
  writeClouds(".csv", [](const LidarCloud& cloud) {
    std::string text = "x,y,z,intensity\r";
    for (std::size_t i = 0; i < cloud.size(); ++i)
      text += fmt::format("{:.9g},{:.9g},{:.9g},{:.9g}\r", cloud.x[i], cloud.y[i], cloud.z[i],
                          cloud.intensity[i]);
    return text;
  });
  expectClouds({}, 0);
}

}  // namespace
}  // namespace perception
