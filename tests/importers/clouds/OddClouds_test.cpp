// Folders of clouds: numbers of another size, times of other units, stamps that go back.
#include <fmt/format.h>
#include <gtest/gtest.h>

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
  writeClouds(".bin", [](const LidarCloud& cloud) {
    std::vector<float> numbers;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      numbers.insert(numbers.end(), {cloud.x[i], cloud.y[i], cloud.z[i], cloud.intensity[i]});
    return bytesOf(numbers);
  });
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

}  // namespace
}  // namespace perception
