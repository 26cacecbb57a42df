#include "libperception/calibration/detectors/BoxEvidenceStudy.h"

#include <gtest/gtest.h>

#include "libperception/core/Error.h"

namespace perception {
namespace {

/// Every second box is on a car; where scores tell, cars score 4 more.
BoxLog log(const char* name, bool tells) {
  BoxLog out;
  out.name = name;
  for (int i = 0; i < 200; ++i) {
    const bool object = i % 2 == 0;
    out.boxes.push_back({"Car", {i % 7 + (object && tells ? 4.0 : 0.0), 20, object}});
  }
  return out;
}

TEST(BoxEvidenceStudy, WritesTheOddsOfEveryLabelUnderItsNameInTheIni) {
  const StudyReport report =
      boxEvidenceStudy("boxes", {log("a", true), log("b", true)}, {{"Car", "car"}});
  ASSERT_EQ(report.tables.size(), 1U);
  const auto& row = report.tables[0].rows.at(0);
  EXPECT_EQ(row[1], "400");
  EXPECT_EQ(row[2], "200");
  EXPECT_LT(std::stod(row[3]), 0.6);  // a coin: 0.69
  const std::string& ini = report.files.at(0).second;
  EXPECT_NE(ini.find("[sensor.boxes.positions]"), std::string::npos);
  EXPECT_NE(ini.find("score_slope.car = 0."), std::string::npos);
  EXPECT_NE(ini.find("score_balance.car = 0.00"), std::string::npos);
}

TEST(BoxEvidenceStudy, JudgesEachLogByWhatTheOthersTaught) {
  const auto table = boxEvidenceStudy("boxes", {log("a", true), log("b", false)}, {}).tables.at(0);
  EXPECT_GT(std::stod(table.rows.at(0)[4]), std::stod(table.rows.at(0)[3]));
}

TEST(BoxEvidenceStudy, RefusesLogsWithoutBoxes) {
  EXPECT_THROW(boxEvidenceStudy("boxes", {BoxLog{}}, {}), DataError);
}

}  // namespace
}  // namespace perception
