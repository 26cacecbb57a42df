#include "libperception/simulation/recorded/BeamPattern.h"

#include <gtest/gtest.h>

#include <set>

#include "libperception/core/math/Angle.h"
#include "tests/simulation/recorded/RecordedClouds.h"

namespace perception {
namespace {

using test::leftHalf, test::wallCloud;

TEST(BeamPattern, AFirstScanLacksNothing) {
  BeamPattern pattern;
  EXPECT_TRUE(pattern.missing(wallCloud(10)).empty());
}

TEST(BeamPattern, BeamsOfEarlierScansWithoutAReturnAreMissing) {
  BeamPattern pattern;
  pattern.missing(wallCloud(10));
  const auto missing = pattern.missing(leftHalf(wallCloud(10)));
  EXPECT_EQ(missing.size(), 8u * 45u);
  std::set<std::uint32_t> slots;
  for (const auto& beam : missing) {
    EXPECT_LT(beam.direction.y(), 0);
    EXPECT_NEAR(beam.direction.norm(), 1, 1e-9);
    slots.insert(beam.slot);
  }
  EXPECT_EQ(slots.size(), missing.size());
}

TEST(BeamPattern, TheRangeOfAReturnDoesNotMatter) {
  BeamPattern pattern;
  pattern.missing(wallCloud(10));
  EXPECT_TRUE(pattern.missing(wallCloud(35)).empty());
}

LidarCloud turned(LidarCloud cloud, double by) {
  const Eigen::Rotation2D<double> turn(by);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector2 p =
        turn * Vector2(static_cast<double>(cloud.x[i]), static_cast<double>(cloud.y[i]));
    cloud.x[i] = static_cast<float>(p.x()), cloud.y[i] = static_cast<float>(p.y());
  }
  return cloud;
}

TEST(BeamPattern, BeamsThatHaveMovedALittleAreNotMissing) {
  BeamPattern pattern;
  for (int turn = 0; turn < 5; ++turn) {  // from a cell of directions to the next one and back
    EXPECT_TRUE(pattern.missing(turned(wallCloud(10), radians(.06))).empty());
    EXPECT_TRUE(pattern.missing(turned(wallCloud(10), radians(.14))).empty());
  }
  // One beam in two cells is one beam, when it is missing.
  EXPECT_NEAR(static_cast<double>(pattern.missing(LidarCloud{}).size()) / (8 * 91), 1, .1);
}

TEST(BeamPattern, FineBeamsThatShareADirectionAreMissedAsMany) {
  LidarCloud twice = wallCloud(10);
  for (LidarCloud more = wallCloud(10.001); more.size() > 0;) {
    for (std::size_t i = 0; i < more.size(); ++i) {
      twice.x.push_back(more.x[i]), twice.y.push_back(more.y[i]), twice.z.push_back(more.z[i]);
    }
    break;
  }
  BeamPattern pattern;
  pattern.missing(twice);
  EXPECT_EQ(pattern.missing(LidarCloud{}).size(), 2u * 8u * 91u);
}

}  // namespace
}  // namespace perception
