#include "libperception/calibration/BoxEvidenceStudy.h"

#include <gtest/gtest.h>

#include "libperception/core/Error.h"

namespace perception {
namespace {

JudgedBox box(double score, double length, bool object) {
  JudgedBox b;
  b.label = "Car";
  b.score = score;
  b.range = 20;
  b.box = {{20, 0, 0}, 0, length, 1.6, 1.5};
  b.object = object;
  return b;
}

// Scores tell nothing; clutter is as long again as cars where `tells`.
BoxLog log(const char* name, bool tells) {
  BoxLog out;
  out.name = name;
  for (int i = 0; i < 200; ++i) {
    const bool object = i % 2 == 0;
    const double spread = 0.1 * (i % 10);
    out.boxes.push_back(box(i % 7, (object || !tells ? 4 : 8) + spread, object));
  }
  return out;
}

TEST(BoxEvidenceStudy, TakesFeaturesThatTellOnLogsLeftOut) {
  const StudyReport report =
      boxEvidenceStudy("boxes", {log("a", true), log("b", true)}, {{"Car", "car"}});
  ASSERT_EQ(report.tables.size(), 1U);
  const auto& row = report.tables[0].rows.at(0);
  EXPECT_EQ(row[1], "400");
  EXPECT_EQ(row[2], "200");
  EXPECT_EQ(row[7], "features");
  EXPECT_LT(std::stod(row[6]), 0.5 * std::stod(row[4]));
  const std::string& ini = report.files.at(0).second;
  EXPECT_NE(ini.find("[sensor.boxes.positions]"), std::string::npos);
  EXPECT_NE(ini.find("weight.length.car = -"), std::string::npos);
}

TEST(BoxEvidenceStudy, LeavesOutFeaturesThatOneLogAloneShows) {
  const StudyReport report = boxEvidenceStudy("boxes", {log("a", true), log("b", false)}, {});
  EXPECT_EQ(report.tables[0].rows.at(0)[7], "score");
  EXPECT_EQ(report.files.at(0).second.find("weight."), std::string::npos);
}

TEST(BoxEvidenceStudy, RefusesLogsWithoutBoxes) {
  EXPECT_THROW(boxEvidenceStudy("boxes", {BoxLog{}}, {}), DataError);
}

}  // namespace
}  // namespace perception
