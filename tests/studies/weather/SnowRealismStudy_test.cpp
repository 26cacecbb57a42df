#include "studies/weather/SnowRealismStudy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "libperception/core/Error.h"
#include "libperception/simulation/weather/particles/Precipitation.h"

namespace perception {
namespace {

// Beams 0.2 by 0.4 deg apart to a wall 40 m away, every twelfth returned by a flake `near` to
// `near` + 1 m away.
std::vector<SnowScan> scans(std::size_t n, double near, std::uint64_t seed) {
  std::vector<SnowScan> all(n);
  for (std::size_t s = 0; s < n; ++s) {
    Rng rng({seed, s, 0, 1});
    all[s].height = 2;
    for (int row = 0; row < 10; ++row) {
      for (int column = 0; column < 60; ++column) {
        const double azimuth = radians(.2) * column, elevation = radians(.4) * (row - 5);
        const bool snow = rng.below(12) == 0;
        const double range = snow ? rng.uniform(near, near + 1) : 40;
        all[s].places.push_back(range * Vector3(std::cos(elevation) * std::cos(azimuth),
                                                std::cos(elevation) * std::sin(azimuth),
                                                std::sin(elevation)));
        all[s].intensity.push_back(snow ? 0 : .3);
        all[s].snow.push_back(snow);
      }
    }
  }
  return all;
}

double areaOf(const StudyReport& report, std::size_t row) {
  return std::stod(report.tables.front().rows[row][1]);
}

TEST(SnowRealismStudy, CannotTellTheSameSnowButOthers) {
  SnowRealismParams params;
  params.block = 2;
  const StudyReport report = snowRealismStudy(
      params, {"real", scans(20, 6, 1)}, {{"same", scans(20, 6, 2)}, {"nearer", scans(20, 4, 3)}});
  ASSERT_EQ(report.tables.size(), 4u);
  ASSERT_EQ(report.tables.front().rows.size(), 4u);
  EXPECT_NEAR(areaOf(report, 1), .5, .08);
  EXPECT_GT(areaOf(report, 2), .95);
  EXPECT_GT(areaOf(report, 3), .9);  // the plain law
  EXPECT_EQ(report.tables[2].rows.front().front(), "range");
}

TEST(SnowRealismStudy, PlainSnowIsOfAllBeamsByTheMeasuredLaw) {
  SnowScan scan;
  for (int i = 0; i < 40000; ++i) {
    scan.places.emplace_back(40, .001 * i, 0);
    scan.intensity.push_back(.5), scan.snow.push_back(i % 4 == 0);
  }
  const SnowScan plain = plainSnow(scan, 2.5, {1, 0, 0, 0});
  double log_sum = 0, square_sum = 0, n = 0;
  for (std::size_t i = 0; i < plain.places.size(); ++i) {
    if (!plain.snow[i]) {
      EXPECT_GE(plain.places[i].norm(), 40);
      continue;
    }
    const double log_range = std::log(plain.places[i].norm());
    ++n, log_sum += log_range, square_sum += log_range * log_range;
    EXPECT_LE(plain.intensity[i], .9);
  }
  EXPECT_NEAR(n, 10000, 400);
  EXPECT_NEAR(log_sum / n, kSnowReturns.log_mean, .03);
  EXPECT_NEAR(std::sqrt(square_sum / n - log_sum * log_sum / n / n), kSnowReturns.log_sigma, .03);
}

TEST(SnowRealismStudy, LogsWithoutLabelsAreRefused) {
  EXPECT_THROW(readSnowScans(PERCEPTION_SOURCE_DIR "/rawlogs/demo.rawlog", {}), DataError);
}

}  // namespace
}  // namespace perception
