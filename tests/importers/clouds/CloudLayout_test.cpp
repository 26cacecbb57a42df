#include "libperception/importers/clouds/CloudLayout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace perception {
namespace {

using Row = std::vector<float>;

/// Returns of a scanner with 16 beams over a road and past walls, beam after beam.
std::vector<Row> scan() {
  std::vector<Row> rows;
  for (int ring = 0; ring < 16; ++ring) {
    const double elevation = (2 * ring - 15) * M_PI / 180;
    for (int k = 0; k < 360; ++k) {
      const double azimuth = k * M_PI / 180, wall = 12 + 8 * std::sin(3 * azimuth);
      const double range = elevation < 0 ? std::min(wall, -1.8 / std::sin(elevation)) : wall;
      rows.push_back({static_cast<float>(range * std::cos(elevation) * std::cos(azimuth)),
                      static_cast<float>(range * std::cos(elevation) * std::sin(azimuth)),
                      static_cast<float>(range * std::sin(elevation)),
                      static_cast<float>((k * 7 % 100) / 100.0), static_cast<float>(ring)});
    }
  }
  return rows;
}

std::vector<float> numbersOf(const std::vector<Row>& rows) {
  std::vector<float> numbers;
  for (const Row& row : rows) numbers.insert(numbers.end(), row.begin(), row.end());
  return numbers;
}

std::vector<std::string> columnsOf(const std::vector<Row>& rows) {
  const auto count = columnCountOf(numbersOf(rows));
  if (!count || *count != rows.front().size()) return {};
  std::vector<std::vector<double>> values(*count);
  for (const Row& row : rows)
    for (std::size_t c = 0; c < *count; ++c) values[c].push_back(static_cast<double>(row[c]));
  const auto layout = layoutOf(values);
  return layout ? layout->columns : std::vector<std::string>();
}

using Names = std::vector<std::string>;

TEST(CloudLayout, ThreeToFiveColumnsAreFound) {
  std::vector<Row> rows = scan();
  EXPECT_EQ(columnsOf(rows), (Names{"x", "y", "z", "intensity", "ring"}));
  for (Row& row : rows) row.pop_back();
  EXPECT_EQ(columnsOf(rows), (Names{"x", "y", "z", "intensity"}));
  for (Row& row : rows) row.pop_back();
  EXPECT_EQ(columnsOf(rows), (Names{"x", "y", "z"}));
}

TEST(CloudLayout, RisingTimesBeforeOrBehindAreTimes) {
  std::vector<Row> before = scan(), behind = scan();
  for (std::size_t i = 0; i < before.size(); ++i) {
    const float time = static_cast<float>(i) * 1e-5F;
    before[i].insert(before[i].begin(), time);
    behind[i].push_back(time);
  }
  EXPECT_EQ(columnsOf(before), (Names{"time", "x", "y", "z", "intensity", "ring"}));
  EXPECT_EQ(columnsOf(behind), (Names{"x", "y", "z", "intensity", "ring", "time"}));
}

TEST(CloudLayout, AnIntensityThatRisesIsNoTime) {
  const double n = static_cast<double>(scan().size());
  std::mt19937 random(3);
  std::uniform_real_distribution<float> noise(0, 1);
  std::vector<Row> counts = scan(), mostly = scan(), bytes = scan(), sorted = scan();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double share = static_cast<double>(i) / n;
    counts[i] = {counts[i][0], counts[i][1], counts[i][2], static_cast<float>(share)};
    // One step of 25 falls.
    mostly[i] = {mostly[i][0], mostly[i][1], mostly[i][2],
                 static_cast<float>(share) * 0.5F + (i % 25 == 0 ? 0.002F : 0.0F)};
    bytes[i] = {bytes[i][0], bytes[i][1], bytes[i][2], std::floor(255 * noise(random))};
    sorted[i] = {sorted[i][0], sorted[i][1], sorted[i][2], 0.2F * noise(random)};
  }
  for (std::vector<Row>* rows : {&bytes, &sorted})
    std::sort(rows->begin(), rows->end(), [](const Row& a, const Row& b) { return a[3] < b[3]; });
  EXPECT_EQ(columnsOf(counts), (Names{"x", "y", "z", "intensity"})) << "through a whole second";
  EXPECT_EQ(columnsOf(bytes), (Names{"x", "y", "z", "intensity"}));
  EXPECT_EQ(columnsOf(sorted), (Names{"x", "y", "z", "intensity"}));
  EXPECT_EQ(columnsOf(mostly), (Names{"x", "y", "z", "intensity"})) << "and falls in between";
}

TEST(CloudLayout, ACoordinateThatWasSortedStaysOne) {
  std::vector<Row> rows = scan();
  std::sort(rows.begin(), rows.end());
  EXPECT_EQ(columnsOf(rows), (Names{"x", "y", "z", "intensity", "ring"}));
}

TEST(CloudLayout, WhatFillsRowsIsSkipped) {
  std::vector<Row> rows = scan();
  for (Row& row : rows) row = {row[0], row[1], row[2], 1, row[3], 0, 0, 0};
  EXPECT_EQ(columnsOf(rows), (Names{"x", "y", "z", "-", "intensity", "-", "-", "-"}));
}

TEST(CloudLayout, TheOrderOfReturnsIsNoMatter) {
  std::vector<Row> rows = scan();
  std::shuffle(rows.begin(), rows.end(), std::mt19937(1));
  EXPECT_EQ(columnsOf(rows), (Names{"x", "y", "z", "intensity", "ring"}));
}

TEST(CloudLayout, ReturnsThatAreNoNumbersDoNotMatter) {
  std::vector<Row> rows = scan();
  for (std::size_t i = 0; i < rows.size(); i += 3)
    rows[i].assign(5, std::numeric_limits<float>::quiet_NaN());
  for (Row& row : rows) row.pop_back();
  EXPECT_EQ(columnsOf(rows), (Names{"x", "y", "z", "intensity"}));
}

TEST(CloudLayout, IntensitiesOfBytesAreTold) {
  std::vector<std::vector<double>> values(4);
  for (const Row& row : scan()) {
    for (std::size_t c = 0; c < 3; ++c) values[c].push_back(static_cast<double>(row[c]));
    values[3].push_back(std::round(static_cast<double>(row[3]) * 255));
  }
  const auto layout = layoutOf(values);
  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->columns[3], "intensity");
  EXPECT_EQ(layout->intensity_max, 255);
}

/// Returns of level ground below the scanner, with noise.
std::vector<Row> levelGround() {
  std::vector<Row> rows;
  for (const Row& row : scan())
    if (std::abs(row[2] + 1.8F) < 0.01F) rows.push_back({row[0], row[1], row[2], row[3]});
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0, 0.02F);
  for (Row& row : rows) row[2] += noise(random);
  return rows;
}

TEST(CloudLayout, LevelGroundAloneHasHeights) {
  const std::vector<Row> rows = levelGround();
  ASSERT_GT(rows.size(), 500u);
  EXPECT_EQ(columnsOf(rows), (Names{"x", "y", "z", "intensity"}));
}

TEST(CloudLayout, GroundThatRisesAboveTheScannerFarAheadHasHeights) {
  std::vector<Row> rows = levelGround();
  for (std::size_t i = 0; i < rows.size(); i += 30) rows[i][2] = 2;
  EXPECT_EQ(columnsOf(rows), (Names{"x", "y", "z", "intensity"}));
}

TEST(CloudLayout, WhatIsNoCloudIsNotTakenForOne) {
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  std::vector<float> noise(20000);
  for (float& v : noise) v = normal(random);
  EXPECT_FALSE(columnCountOf(noise));
  EXPECT_FALSE(columnCountOf(std::vector<float>(100, 1.F))) << "too few";
  std::vector<std::vector<double>> far(4);
  for (const Row& row : scan())
    for (std::size_t c = 0; c < 4; ++c) far[c].push_back(static_cast<double>(row[c]) + 5e5);
  EXPECT_FALSE(layoutOf(far)) << "coordinates of a map";
}

}  // namespace
}  // namespace perception
