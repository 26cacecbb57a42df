#include "libperception/calibration/detectors/LearntStudy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/Error.h"

namespace perception {
namespace {

constexpr double kStatedConfidence = 0.75;

/// A box a frame that is an object with `share` in every ten frames, stated as kStatedConfidence.
BoxLog logWith(int frames, double share) {
  BoxLog log;
  log.name = "a";
  for (int f = 0; f < frames; ++f)
    log.boxes.push_back({"Car",
                         {0, 20, f % 10 < 10 * share - 1e-9},
                         f,
                         std::log(kStatedConfidence / (1 - kStatedConfidence))});
  return log;
}

TEST(LearntStudy, TheErrorIsTheDistanceOfStatedAndTrueShare) {
  const StudyReport report = learntStudy({{"net", {logWith(400, 0.5)}}});
  const auto& row = report.tables.at(0).rows.at(0);
  EXPECT_EQ(row[3], "0.250");
  EXPECT_EQ(row[4], "200") << "boxes from frame 200 on";
  EXPECT_EQ(row[5], "0.750");
  EXPECT_EQ(row[6], "0.500");
  EXPECT_EQ(row[7], "0.250");
}

TEST(LearntStudy, ByChanceTheErrorOfTrueProbabilitiesFallsWithTheRootOfTheBoxes) {
  const auto chance = [](int frames) {
    return std::stod(learntStudy({{"net", {logWith(frames, 0.5)}}}).tables.at(0).rows.at(0)[8]);
  };
  EXPECT_NEAR(chance(300), std::sqrt(2 / M_PI * 0.75 * 0.25 / 100), 6e-4);
  EXPECT_NEAR(chance(300) / chance(600), 2, 0.1);  // 100 and 400 boxes
}

TEST(LearntStudy, ConvergenceIsByFrameSinceTheBeginOfEveryLog) {
  BoxLog log = logWith(100, 0.5);
  for (BoxWithTruth& b : log.boxes)
    if (b.scan >= 50) b.stated = 0;  // learned: .5
  const auto rows = learntStudy({{"net", {log, log}}}).tables.at(2).rows;
  ASSERT_EQ(rows.size(), 3U);  // frames 0, 25 and 50 on
  EXPECT_EQ(rows[0][2], "50");
  EXPECT_EQ(rows[0][3], "0.150") << "15 of 25";
  EXPECT_EQ(rows[2][1], "50");
  EXPECT_EQ(rows[2][3], "0.000");
}

TEST(LearntStudy, EveryDetectorHasItsCurve) {
  const StudyReport report =
      learntStudy({{"one", {logWith(300, 0.5)}}, {"two", {logWith(300, 0.7)}}});
  const auto& rows = report.tables.at(1).rows;
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[1][0], "two");
  EXPECT_EQ(rows[1][3], "0.700");
  ASSERT_EQ(report.plots.size(), 2U);
  EXPECT_EQ(report.plots[0].data.at(0).second, "0.75 0.5\n\n\n0.75 0.7\n\n\n");
}

TEST(LearntStudy, RefusesLogsWithoutBoxes) {
  EXPECT_THROW(learntStudy({{"net", {BoxLog{}}}}), DataError);
}

}  // namespace
}  // namespace perception
