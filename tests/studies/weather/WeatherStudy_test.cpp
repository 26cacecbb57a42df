#include "studies/weather/WeatherStudy.h"

#include <gtest/gtest.h>

#include "libperception/core/Error.h"

namespace perception {
namespace {

TEST(WeatherStudy, CountsTheTypesOfALog) {
  const std::string root = PERCEPTION_SOURCE_DIR;
  WeatherOptions options;
  options.logs = {root + "/ini/demo.ini=" + root + "/rawlogs/demo.rawlog=clear",
                  root + "/ini/demo.ini=" + root + "/rawlogs/demo.rawlog=fog"};
  const StudyReport report = weatherStudy(options, 1);
  ASSERT_EQ(report.tables.size(), 1U);
  const auto& rows = report.tables.front().rows;
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0][2], rows[0][3]);  // all scans are clear
  EXPECT_EQ(rows[0][7], "100.0");
  EXPECT_EQ(rows[1][7], "0.0");
  EXPECT_EQ(rows[2][0], "all clear ones");
  EXPECT_EQ(rows[2][2], rows[0][2]);
}

TEST(WeatherStudy, NothingToJudgeIsAUsageError) { EXPECT_THROW(weatherStudy({}, 1), Error); }

}  // namespace
}  // namespace perception
