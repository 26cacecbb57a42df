#include "studies/obstacles/ObstaclesStudy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "libperception/core/Error.h"

namespace perception {
namespace {

ObstaclesOptions shortRun() {
  ObstaclesOptions options;
  options.config = PERCEPTION_SOURCE_DIR "/ini/kitti.ini";
  options.beams = {32};
  options.speeds = {5};
  options.weather = {"clear"};
  options.lead = 1;
  return options;
}

const std::string& cell(const StudyTable& table, std::size_t row, const std::string& column) {
  const auto at = std::find(table.columns.begin(), table.columns.end(), column);
  return table.rows.at(row).at(static_cast<std::size_t>(at - table.columns.begin()));
}

TEST(ObstaclesStudy, ADrumIsCalledForWithIntensitiesAndWithout) {
  ObstaclesOptions options = shortRun();
  options.shapes = {"drum lying"};
  const StudyReport report = obstaclesStudy(options, 1);
  EXPECT_EQ(report.data.rfind("simulated", 0), 0u);
  const StudyTable& sensors = report.tables.front();
  ASSERT_EQ(sensors.rows.size(), 2u);
  for (const std::size_t row : {0u, 1u}) {
    EXPECT_EQ(cell(sensors, row, "shown in time"), "1");
    EXPECT_EQ(cell(sensors, row, "missed"), "0");
    EXPECT_EQ(cell(sensors, row, "false stops"), "0");
  }
  EXPECT_EQ(cell(sensors, 0, "intensity"), "given");
  EXPECT_EQ(cell(sensors, 1, "intensity"), "none");
}

TEST(ObstaclesStudy, AnEmptyRoadStopsNobody) {
  ObstaclesOptions options = shortRun();
  options.shapes = {"empty road"};
  const StudyReport report = obstaclesStudy(options, 1);
  EXPECT_EQ(cell(report.tables.front(), 0, "shown in time"), "0");
  EXPECT_EQ(cell(report.tables.front(), 0, "false stops"), "0");
  EXPECT_EQ(cell(report.tables.front(), 0, "clusters' false stops"), "0");
}

TEST(ObstaclesStudy, AnUnknownShapeIsRefused) {
  ObstaclesOptions options = shortRun();
  options.shapes = {"unicorn"};
  EXPECT_THROW(obstaclesStudy(options, 1), Error);
}

}  // namespace
}  // namespace perception
