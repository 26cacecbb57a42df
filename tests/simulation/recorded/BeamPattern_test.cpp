#include "libperception/simulation/recorded/BeamPattern.h"

#include <gtest/gtest.h>

#include <set>

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
