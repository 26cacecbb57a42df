#include <gtest/gtest.h>

#include "libperception/core/Error.h"
#include "libperception/evaluation/tables/Report.h"
#include "tests/evaluation/MakeRun.h"

namespace perception {
namespace {

using namespace testing_evaluation;

// A car for ten instants, tracked from `first` on.
EvaluatedRun runFrom(const std::string& name, std::int64_t first, std::uint64_t id = 1) {
  TrackedRun run = makeRun();
  std::vector<TruthObject> truth;
  for (std::int64_t k = 0; k < 10; ++k) {
    truth.push_back(makeTruth(k, 5, 10, 0));
    run.scenes.push_back(
        makeScene(k, k < first ? std::vector<SceneObject>{} : std::vector{makeObject(id, 10, 0)}));
  }
  return {name, name, evaluate(run, makeGroundTruth(truth), {})};
}

TEST(Pooled, InstantsOfAllRunsCountAlike) {
  const EvaluatedRun both = pooledRun("both", {runFrom("a", 0), runFrom("b", 5)});
  const TrackingFigures f = trackingFigures(both.evaluation, Pairing::kClosest);
  EXPECT_EQ(f.active, 20u);
  EXPECT_EQ(f.returns, 15u);
  EXPECT_DOUBLE_EQ(*f.tracked_a, 0.75);
  EXPECT_EQ(both.trials.size(), 2u);
}

TEST(Pooled, ObjectsOfDifferentRunsStayDifferent) {
  const EvaluatedRun both = pooledRun("both", {runFrom("a", 0, 1), runFrom("b", 0, 2)});
  EXPECT_EQ(trackingFigures(both.evaluation, Pairing::kOneToOne).id_switches, 0u);
  EXPECT_EQ(objectTimelines(both.evaluation, Pairing::kOneToOne).size(), 2u);
}

TEST(Pooled, RunsOfOtherClassesAreRefused) {
  EvaluatedRun other = runFrom("b", 0);
  other.evaluation.class_names[0] = "tram";
  EXPECT_THROW(pooledRun("both", {runFrom("a", 0), other}), DataError);
}

TEST(SideBySide, ShowsMeanDeviationAndRangeOverTheTrials) {
  EvaluationReport report;
  report.runs = {pooledRun("both", {runFrom("a", 0), runFrom("b", 5)}), runFrom("c", 2)};
  for (const PaperTrackingRow& row : paperTrackingRows()) {
    if (row.table == std::string("sunny")) report.paper.push_back(row);
  }
  const ReportTable table = sideBySideTable(report);
  ASSERT_EQ(table.header.size(), 6u);
  EXPECT_EQ(table.header[1], "both, 2 trials");
  EXPECT_EQ(table.header[3], "Radecki et al.: L+R, Sunny");
  EXPECT_EQ(table.rows[0][0], "Object Tracked");
  EXPECT_EQ(table.rows[0][1], "0.750 (0.750 +- 0.354; 0.500..1.000)");
  EXPECT_EQ(table.rows[0][2], "0.800");
  EXPECT_EQ(table.rows[0][3], "0.999");
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.header.size());
}

TEST(PaperTables, AWeatherIsOfOneTableAtMost) {
  const auto of = [](const std::string& weather) {
    std::string tables;
    for (const char* table : {"sunny", "night", "wet", "snow"})
      if (paperTableHasWeather(table, weather)) tables += table;
    return tables;
  };
  EXPECT_EQ(of(""), "sunny");
  EXPECT_EQ(of("sunny"), "sunny");
  EXPECT_EQ(of("night"), "night");
  EXPECT_EQ(of("water film 0.6 mm, cloudy"), "wet");
  EXPECT_EQ(of("rain 5 mm/h, snow 1 mm/h, water film 0.6 mm, snow cover 0.5, cloudy"), "snow");
  EXPECT_EQ(of("snow cover 0.5"), "sunny");  // lies, does not fall
  EXPECT_EQ(of("fog 50 m"), "");
  EXPECT_TRUE(paperConditionHasWeather("Rainy", "rain 10 mm/h"));
  EXPECT_FALSE(paperConditionHasWeather("Rainy", ""));
}

TEST(PaperTables, RowsSumToTheirParts) {
  // Correct, mis- and unclassified are shares of one whole; returns of L+R and C+L+R are those of
  // persons and vehicles together (3972 + 2565 and 3964 + 2594).
  int lidar = 0, full = 0;
  for (const PaperTrackingRow& row : paperTrackingRows()) {
    EXPECT_LE(row.correct + row.mis, 1);
    const std::string table = row.table;
    const bool weather = table == "wet" || table == "sunny" || table == "night" || table == "snow";
    if (weather && row.sensors == std::string("L+R")) lidar += row.returns;
    if (weather && row.sensors == std::string("C+L+R")) full += row.returns;
  }
  EXPECT_EQ(lidar, 3972 + 2565);
  EXPECT_EQ(full, 3964 + 2594);
}

}  // namespace
}  // namespace perception
