// Folders of clouds: stamps in other units, in names of files and in time zones; poses in other
// forms.
#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/importers/OddRecording.h"

namespace perception {
namespace {

using namespace test;

/// Three scans with names, and their times [s] after kBegin.
class OddTimes : public OddRecording {
 protected:
  void writeNamed(const std::vector<std::string>& names) {
    for (std::size_t k = 0; k < names.size(); ++k) {
      const LidarCloud cloud = oneTurn(static_cast<int>(k));
      std::vector<float> numbers;
      for (std::size_t i = 0; i < cloud.size(); ++i)
        numbers.insert(numbers.end(), {cloud.x[i], cloud.y[i], cloud.z[i], cloud.intensity[i]});
      write("clouds/" + names[k] + ".bin", bytesOf(numbers));
    }
  }
  std::vector<double> times(const std::vector<std::string>& more) {
    std::filesystem::remove(file("out.rawlog"));
    expectClouds(more, 0);
    return timesOf("LIDAR_TOP");
  }
};

TEST_F(OddTimes, StampsInEveryUnitAndWithAZoneAreRead) {
  writeNamed({"1", "2", "10"});
  for (const char* stamps :
       {"1700000000.5\n1700000000.75\n1700000001\n",
        "1700000000500\n1700000000750\n1700000001000\n",
        "1700000000500000\n1700000000750000\n1700000001000000\n",
        "1700000000500000000\n1700000000750000000\n1700000001000000000\n",
        "2023-11-14T23:13:20.5+01:00\n2023-11-14T22:13:20.75Z\n2023-11-14 16:43:21-0530\n"}) {
    write("stamps.txt", stamps);
    const auto got = times({"--stamps", file("stamps.txt")});
    ASSERT_EQ(got.size(), 3U);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(got[k], 0.5 + 0.25 * static_cast<double>(k), 1e-6) << stamps;
  }
  for (const char* none : {"2023-11-14T22:13:20+1\n", "2023-11-14T22:13:20+01:0\n", "17e8\n"}) {
    write("stamps.txt", none);
    std::filesystem::remove(file("out.rawlog"));
    expectFault(65, "stamps.txt:1: expected seconds since 1970", "clouds",
                {"--clouds", file("clouds"), "--stamps", file("stamps.txt")});
  }
}

TEST_F(OddTimes, FilesThatAreNamedByTheirTimesHaveThem) {
  writeNamed({"1700000000500000000", "1700000000750000000", "1700000001000000000"});
  EXPECT_EQ(times({}), (std::vector<double>{0.5, 0.75, 1}));
  expectSaid("the files are named by their times, which are taken (--rate)");
  const auto counted = times({"--rate", "20"});
  EXPECT_NEAR(counted[2] - counted[0], 0.1, 1e-6);
  write("poses.txt", "1700000000.4 0 0 0 0 0 0 1\n1700000001.4 10 0 0 0 0 0 1\n");
  times({"--poses", file("poses.txt"), "--poses-format", "tum"});
  EXPECT_NEAR(framesOf("LIDAR_TOP")[1].ego.T_world_ego.translation().x(), 3.5, 1e-5)
      << "poses with times are matched by them";
}

TEST_F(OddTimes, NamesThatCountAreNoTimes) {
  writeNamed({"1000000001", "1000000002", "1000000003x"});
  times({});
  expectSaid("no --stamps: taken as 10 scans a second");
}

TEST_F(OddTimes, PosesMayHaveCommasAndRemarks) {
  writeNamed({"0", "1", "2"});
  write("poses.txt",
        "# made by hand\n1,0,0,0,0,1,0,0,0,0,1,0\n1, 0, 0, 2, 0, 1, 0, 0, 0, 0, 1, 0\n"
        "1 0 0 4 0 1 0 0 0 0 1 0\n");
  times({"--poses", file("poses.txt")});
  EXPECT_NEAR(framesOf("LIDAR_TOP")[2].ego.T_world_ego.translation().x(), 4, 1e-6);
}

TEST_F(OddTimes, QuaternionsInTheOtherOrderAreTold) {
  writeNamed({"0", "1", "2"});
  write("poses.txt", "0 0 0 0 1 0 0 0\n1 1 0 0 0.99995 0 0 0.01\n2 2 0 0 0.9998 0 0 0.02\n");
  const std::vector<std::string> options{"--clouds",        file("clouds"),   "--poses",
                                         file("poses.txt"), "--poses-format", "tum"};
  ASSERT_EQ(import("clouds", options), 3) << error_;
  expectSaid("all poses stand upside down; expected t x y z qx qy qz qw");
}

}  // namespace
}  // namespace perception
