// Recordings whose drivers write a far place where a beam met nothing.
#include "libperception/importers/ScanOddities.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "tests/importers/OddRecording.h"

namespace perception {
namespace {

using namespace test;

/// Every third beam of a turn meets nothing: it has this range [m].
LidarCloud withNothing(int scan, double range) {
  LidarCloud cloud = oneTurn(scan);
  for (std::size_t i = 0; i < cloud.size(); i += 3) {
    const double a = radians(static_cast<double>(i) / 2);
    cloud.x[i] = static_cast<float>(range * std::cos(a));
    cloud.y[i] = static_cast<float>(range * std::sin(a));
    cloud.z[i] = 0, cloud.intensity[i] = 0;
  }
  return cloud;
}

class ScanOdditiesRun : public OddRecording {
 protected:
  static std::vector<Planned> driveOf(const std::function<LidarCloud(int)>& cloud) {
    const auto same = [](double t) { return t; };
    std::vector<Planned> plan = drive(same, same);
    int k = 0;
    for (Planned& p : plan) {
      if (p.topic != "/points") continue;
      p.bytes = [cloud, k](Stamp stamp) { return cloudBytes(cloud(k), stamp, "velodyne"); };
      ++k;
    }
    return plan;
  }
  void expectCleared(const LidarCloud& got) {
    std::vector<float> expected;  // of a log's points without a place the reader says nothing
    const LidarCloud turn = oneTurn(3);
    for (std::size_t i = 0; i < turn.size(); ++i)
      if (i % 3 != 0) expected.push_back(turn.x[i]);
    EXPECT_EQ(got.x, expected);
  }
};

TEST_F(ScanOdditiesRun, BeamsWithoutReturnThatHaveAFarPlaceAreSaidOnceAndLeftOut) {
  for (const double range : {1e10, 1e6, 65535.0, 262.14, 200.0}) {
    importOf(driveOf([range](int k) { return withNothing(k, range); }), 0);
    expectSaid("points: 4800 points of 20 scans are no returns");
    const auto frames = framesOf("points");
    ASSERT_EQ(frames.size(), 20U);
    expectCleared(std::get<LidarCloud>(frames[3].data));
  }
}

TEST_F(ScanOdditiesRun, OfFilesTheyAreLeftOutToo) {
  writeClouds(".pcd", [](const LidarCloud& turn) {
    const LidarCloud cloud =
        withNothing(static_cast<int>(std::lround((turn.x[0] - 15) * 100)), 1e9);
    std::string text = fmt::format(
        "FIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH {0}\nHEIGHT 1\n"
        "POINTS {0}\nDATA ascii\n",
        cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i)
      text += fmt::format("{} {} {} {}\n", cloud.x[i], cloud.y[i], cloud.z[i], cloud.intensity[i]);
    return text;
  });
  ASSERT_EQ(import("clouds", {"--clouds", file("clouds")}), 0) << error_;
  expectSaid("LIDAR_TOP: 720 points of 3 scans are no returns");
}

TEST_F(ScanOdditiesRun, ScansInMillimetersAreRefused) {
  const auto plan = driveOf([](int k) {
    LidarCloud cloud = oneTurn(k);
    for (auto* values : {&cloud.x, &cloud.y, &cloud.z})
      for (float& v : *values) v *= 1000;
    return cloud;
  });
  importOf(plan, 65);
  expectSaid("points: most returns of 20 of 20 scans lie farther than 1000 m, each elsewhere");
}

TEST_F(ScanOdditiesRun, NumbersOfTheOtherByteOrderThanTheMessageSaysAreRefused) {
  const auto same = [](double t) { return t; };
  std::vector<Planned> plan = drive(same, same);
  for (Planned& p : plan) {
    if (p.topic != "/points") continue;
    p.bytes = [](Stamp stamp) {
      std::string data;
      ros::PointCloud2 message = ros::messageOf(oneTurn(0), {stamp, "velodyne"}, data);
      message.is_bigendian = 1;
      return ros::encoded(message, ros::Encoding::kCdr);
    };
  }
  importOf(plan, 65);
}

TEST_F(ScanOdditiesRun, OneScanThatIsElsewhereIsSaidAndLeftOutAlone) {
  const auto plan = driveOf([](int k) {
    LidarCloud cloud = oneTurn(k);
    if (k == 7)
      for (float& x : cloud.x) x += 5e5F;
    return cloud;
  });
  importOf(plan, 3);
  expectSaid("points: 1 of 20 scans have most returns farther than 1000 m: left out");
  EXPECT_EQ(framesOf("points").size(), 20U);
}

TEST(ScanOddities, TimesOfWhatIsNoReturnDoNotMatter) {
  SensorFrame frame;
  frame.sensor = "L";
  LidarCloud cloud = withNothing(0, 1e6);
  for (std::size_t i = 0; i < cloud.size(); i += 3) cloud.time_offset[i] = -1.7e9F;
  frame.data = cloud;
  ScanOddities oddities;
  const auto mended = oddities.mended(frame);
  ASSERT_TRUE(mended);
  EXPECT_EQ(std::get<LidarCloud>(mended->data).time_offset, cloud.time_offset);
  frame.data = oneTurn(0);
  EXPECT_FALSE(oddities.mended(frame));
  std::vector<std::string> notes, warnings;
  oddities.tell(notes, warnings);
  EXPECT_EQ(notes.size(), 1U);
  EXPECT_TRUE(warnings.empty());
}

}  // namespace
}  // namespace perception
