#include "libperception/calibration/clusters/ScanVariants.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

/// 16 beams, 2 degrees apart, with a return every .2 degrees at 20 m all around, 1.7 m above
/// ground.
SensorFrame cylinder() {
  LidarCloud cloud;
  for (int column = 0; column < 1800; ++column) {
    for (int beam = 0; beam < 16; ++beam) {
      const double azimuth = radians(-179.9 + 0.2 * column), elevation = radians(-15 + 2 * beam);
      const double level = 20 * std::cos(elevation);
      cloud.x.push_back(static_cast<float>(level * std::cos(azimuth)));
      cloud.y.push_back(static_cast<float>(level * std::sin(azimuth)));
      cloud.z.push_back(static_cast<float>(20 * std::sin(elevation)));
      cloud.intensity.push_back(0.5F);
    }
  }
  SensorFrame frame;
  frame.T_ego_sensor.translation().z() = 1.7;
  frame.data = std::move(cloud);
  return frame;
}

const LidarCloud& cloudOf(const SensorFrame& frame) { return std::get<LidarCloud>(frame.data); }
float rangeOf(const LidarCloud& c, std::size_t i) { return std::hypot(c.x[i], c.y[i], c.z[i]); }

TEST(BeamNumbers, AreFoundFromElevations) {
  const SensorFrame frame = cylinder();
  const auto beam = beamNumbers(cloudOf(frame));
  for (std::size_t i = 0; i < beam.size(); ++i) ASSERT_EQ(beam[i], i % 16) << i;
}

TEST(BeamNumbers, AreTheRingsWhereTheCloudHasThem) {
  SensorFrame frame = cylinder();
  auto& cloud = std::get<LidarCloud>(frame.data);
  cloud.ring.assign(cloud.size(), 7);
  EXPECT_EQ(beamNumbers(cloud), cloud.ring);
}

TEST(VariedScan, OfHalfTheBeamsHasEverySecondOne) {
  const SensorFrame frame = cylinder();
  const VariedScan half = variedScan(frame, ScanVariant::kHalfBeams, 1);
  EXPECT_EQ(cloudOf(half.frame).size(), cloudOf(frame).size() / 2);
  const VariedScan quarter = variedScan(frame, ScanVariant::kQuarterBeams, 1);
  EXPECT_EQ(cloudOf(quarter.frame).size(), cloudOf(frame).size() / 4);
  const auto beam = beamNumbers(cloudOf(quarter.frame));
  EXPECT_EQ(std::set<std::uint16_t>(beam.begin(), beam.end()).size(), 4u);
}

TEST(VariedScan, OfHalfTheColumnsHasHalfTheReturns) {
  const SensorFrame frame = cylinder();
  const VariedScan half = variedScan(frame, ScanVariant::kHalfColumns, 1);
  EXPECT_NEAR(
      static_cast<double>(cloudOf(half.frame).size()) / static_cast<double>(cloudOf(frame).size()),
      0.5, 0.01);
}

TEST(VariedScan, KeepsWhatIsKnownOfEachReturn) {
  const SensorFrame frame = cylinder();
  const VariedScan half = variedScan(frame, ScanVariant::kHalfBeams, 1);
  ASSERT_EQ(half.source.size(), cloudOf(half.frame).size());
  for (std::size_t i = 0; i < half.source.size(); i += 97)
    EXPECT_EQ(cloudOf(half.frame).x[i], cloudOf(frame).x[half.source[i]]);
  EXPECT_EQ(cloudOf(half.frame).intensity.size(), half.source.size());
}

TEST(VariedScan, OfAPlainSensorHasNoIntensitiesAndNoisyRanges) {
  const SensorFrame frame = cylinder();
  const VariedScan plain = variedScan(frame, ScanVariant::kPlain, 1);
  const LidarCloud& cloud = cloudOf(plain.frame);
  EXPECT_TRUE(cloud.intensity.empty());
  double squares = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    squares += std::pow(static_cast<double>(rangeOf(cloud, i)) - 20, 2);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(cloud.size())), 0.03, 0.002);
}

TEST(VariedScan, HidesWhatIsBehindPostsAlongItsRays) {
  const SensorFrame frame = cylinder();
  const VariedScan hidden = variedScan(frame, ScanVariant::kHidden, 1);
  const LidarCloud &before = cloudOf(frame), &after = cloudOf(hidden.frame);
  ASSERT_EQ(after.size(), before.size());
  const auto moved = std::count(hidden.moved.begin(), hidden.moved.end(), true);
  EXPECT_GT(moved, 500);
  EXPECT_LT(moved, static_cast<std::ptrdiff_t>(after.size() / 2));
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (hidden.moved[i]) {
      EXPECT_LT(rangeOf(after, i), 20);
    } else {
      EXPECT_EQ(after.x[i], before.x[i]);
    }
    EXPECT_NEAR(std::atan2(after.y[i], after.x[i]), std::atan2(before.y[i], before.x[i]), 1e-5);
  }
}

TEST(VariedScan, IsTheSameForTheSameSeed) {
  const SensorFrame frame = cylinder();
  const auto placesOf = [&](std::uint64_t seed) {
    return cloudOf(variedScan(frame, ScanVariant::kHidden, seed).frame).x;
  };
  EXPECT_EQ(placesOf(3), placesOf(3));
  EXPECT_NE(placesOf(3), placesOf(4));
}

}  // namespace
}  // namespace perception
