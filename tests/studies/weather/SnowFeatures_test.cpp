#include "studies/weather/SnowFeatures.h"

#include <gtest/gtest.h>

#include <cmath>

namespace perception {
namespace {

void add(LidarCloud& cloud, std::vector<std::uint16_t>& labels, double azimuth_deg,
         double elevation_deg, double range, float intensity, std::uint16_t label) {
  const double azimuth = radians(azimuth_deg), elevation = radians(elevation_deg);
  cloud.x.push_back(static_cast<float>(range * std::cos(elevation) * std::cos(azimuth)));
  cloud.y.push_back(static_cast<float>(range * std::cos(elevation) * std::sin(azimuth)));
  cloud.z.push_back(static_cast<float>(range * std::sin(elevation)));
  cloud.intensity.push_back(intensity);
  labels.push_back(label);
}

TEST(SnowFeatures, ComparableScansHaveOneReturnACellAndNoneOutside) {
  LidarCloud cloud;
  std::vector<std::uint16_t> labels;
  add(cloud, labels, 10.1, 0.2, 30, .5f, 50);    // in the middle of its cell
  add(cloud, labels, 10.1, 0.2, 6, .1f, 110);    // first echo of the same pulse
  add(cloud, labels, 10.18, 0.35, 5, .1f, 110);  // the same cell's edge
  add(cloud, labels, 45, 0.2, 6, .1f, 110);      // beside the sector
  add(cloud, labels, 10.1, 5, 6, .1f, 110);      // above it
  add(cloud, labels, 20.1, 0.2, 2, .1f, 110);    // too near
  const SnowScan scan = comparableScan(cloud, labels, 2, {});
  ASSERT_EQ(scan.places.size(), 1u);
  EXPECT_NEAR(scan.places[0].norm(), 6, 1e-4);
  EXPECT_TRUE(scan.snow[0]);
  EXPECT_EQ(scan.height, 2);
}

TEST(SnowFeatures, AreThoseOfAHandmadeScan) {
  LidarCloud cloud;
  std::vector<std::uint16_t> labels;
  add(cloud, labels, 0.1, 0.2, 10, 0, 110);
  add(cloud, labels, 0.7, 0.2, 10.1, 0, 110);    // adjacent
  add(cloud, labels, 2.1, 0.2, 10.1, .2f, 110);  // 2 deg away
  add(cloud, labels, 0.3, 0.2, 10.05, .5f, 50);  // a surface, the nearest of all
  add(cloud, labels, 0.1, 0.6, 40, 1, 50);
  const SnowSector sector;
  const auto rows = snowFeatures(comparableScan(cloud, labels, 2, sector), sector);
  ASSERT_EQ(rows.size(), 3u);  // by azimuth
  const SnowFeatures& f = rows[0];
  EXPECT_NEAR(f[0], 10, 1e-4);
  EXPECT_NEAR(f[1], .2, 1e-6);  // two of five are 0: ranks 0 to 2, the middle
  EXPECT_NEAR(f[2], std::hypot(10 * radians(.2), .05) / 10, 1e-4);
  EXPECT_NEAR(f[5], std::hypot(10 * radians(.6), .1) / 10, 1e-4);
  EXPECT_EQ(f[6], 1);  // there is no third neighbor of snow
  EXPECT_EQ(f[8], 1);
  EXPECT_NEAR(f[9], 2 + 10 * std::sin(radians(.2)), 1e-4);
  EXPECT_EQ(rows[2][8], 0);
}

}  // namespace
}  // namespace perception
