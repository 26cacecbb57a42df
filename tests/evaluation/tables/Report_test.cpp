#include "libperception/evaluation/tables/Report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <clocale>
#include <locale>
#include <nlohmann/json.hpp>

#include "tests/evaluation/MakeRun.h"

namespace perception {
namespace {

using namespace testing_evaluation;

// A car tracked at two of three instants, a false person at the last.
EvaluationReport sampleReport(bool with_truth = true) {
  TrackedRun run = makeRun();
  run.scenes = {makeScene(0), makeScene(1, {makeObject(1, 10, 0)}),
                makeScene(2, {makeObject(1, 10, 0), makeObject(2, 3, 8, kPedestrian)})};
  std::vector<TruthObject> truth;
  if (with_truth) truth = {makeTruth(0, 5, 10, 0), makeTruth(1, 5, 10, 0), makeTruth(2, 5, 10, 0)};
  EvaluationReport report;
  report.command = "perception-evaluate -r first_run -t log.truth.csv";
  report.runs.push_back({"first_run", "first_run", evaluate(run, makeGroundTruth(truth), {}), {}});
  return report;
}

TEST(Report, ThePapersTableComesFirstWithItsColumnsInItsOrder) {
  const ReportTable table = reportTables(sampleReport()).front();
  EXPECT_EQ(table.header,
            (std::vector<std::string>{"Run", "Class", "Object Tracked", "Range Error (m)",
                                      "Bearing Error (rad)", "Correct Classification",
                                      "Mis-Classification", "Number of Returns"}));
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0], (std::vector<std::string>{"first_run", "all", "0.667", "0.000", "0.000",
                                                     "1.000", "0.000", "2"}));
  EXPECT_EQ(table.rows[1][1], "car");
}

TEST(Report, TheSummaryHasTheFiguresThatDecide) {
  const std::string text = summaryText(sampleReport());
  EXPECT_NE(text.find("first_run: 3 instants, 3 views of true objects that count\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("0.667 of the views; 0 id switches, 0 gaps"), std::string::npos) << text;
  EXPECT_NE(text.find("right and sure 1.000, wrong and sure 0.000, not sure 0.000"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("0.33 an instant, of a sure class 0.33"), std::string::npos) << text;
  EXPECT_NE(text.find("MOTA 0.333"), std::string::npos) << "one miss, one false of three" << text;
  const std::string nothing = summaryText(sampleReport(false));
  EXPECT_NE(nothing.find("n/a of the views; n/a id switches"), std::string::npos) << nothing;
}

TEST(Report, TheWorstInstantsComeFirstWithWhatIsWrongInThem) {
  TrackedRun run = makeRun();
  run.scenes = {makeScene(0, {makeObject(1, 10, 0)}), makeScene(1),
                makeScene(2, {makeObject(1, 10, 0, kPedestrian), makeObject(2, 3, 8)})};
  EvaluationReport report;
  report.runs.push_back({"run",
                         "run",
                         evaluate(run,
                                  makeGroundTruth({makeTruth(0, 5, 10, 0), makeTruth(1, 5, 10, 0),
                                                   makeTruth(2, 5, 10, 0)}),
                                  {}),
                         {}});
  const auto tables = reportTables(report);
  const auto worst = std::find_if(tables.begin(), tables.end(), [](const ReportTable& t) {
    return t.title == "Worst instants: run";
  });
  ASSERT_NE(worst, tables.end());
  ASSERT_EQ(worst->rows.size(), 2u) << "the first instant has no fault";
  const std::vector<std::string> first(worst->rows[0].begin(), worst->rows[0].begin() + 5);
  EXPECT_EQ(first, (std::vector<std::string>{"-", "Car 5 as pedestrian", "car 2", "0.20", "2"}));
  const std::vector<std::string> second(worst->rows[1].begin(), worst->rows[1].begin() + 5);
  EXPECT_EQ(second, (std::vector<std::string>{"Car 5", "-", "-", "0.10", "1"}));
}

TEST(Report, EveryRowHasTheHeadersCells) {
  for (const ReportTable& table : reportTables(sampleReport())) {
    EXPECT_FALSE(table.rows.empty()) << table.title;
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.header.size()) << table.title;
  }
}

TEST(Report, SaysNotAvailableWhereThereIsNoTruth) {
  const EvaluationReport report = sampleReport(false);
  const ReportTable table = reportTables(report).front();
  for (std::size_t c = table.labels; c < table.header.size(); ++c)
    EXPECT_EQ(table.rows.at(0)[c], "n/a");
  const std::string text = textReport(report);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  const auto json = nlohmann::json::parse(jsonReport(report));
  EXPECT_TRUE(json["runs"][0]["closest"]["all"]["object_tracked_a"].is_null());
  EXPECT_TRUE(json["runs"][0]["closest"]["all"]["returns"].is_null());
  EXPECT_TRUE(json["runs"][0]["set_distance"]["gospa_mean_m"].is_null());
  EXPECT_TRUE(json["runs"][0]["false_objects"]["all"]["per_instant"].is_null());
}

TEST(Report, JsonHoldsTheTablesFigures) {
  const auto json = nlohmann::json::parse(jsonReport(sampleReport()));
  const auto& run = json["runs"][0];
  EXPECT_NEAR(run["closest"]["all"]["object_tracked_a"].get<double>(), 2.0 / 3, 1e-12);
  EXPECT_NEAR(run["one_to_one"]["truth_objects"][0]["time_to_first_track_s"].get<double>(), 0.1,
              1e-9);
  EXPECT_EQ(run["false_objects"]["classes"]["pedestrian"]["false"], 1);
  EXPECT_EQ(run["closest"]["confusion"]["Car"]["car"], 2);
  EXPECT_EQ(run["instants"].size(), 3u);
  EXPECT_EQ(json["options"]["tolerance_m"], 2);
  EXPECT_EQ(json["command"], "perception-evaluate -r first_run -t log.truth.csv");
}

TEST(Report, TextAndMarkdownShowCommandDefinitionsAndFigures) {
  EvaluationReport report = sampleReport();
  report.plots = {"plots/over view.png"};
  for (const std::string& text : {textReport(report), markdownReport(report)}) {
    EXPECT_NE(text.find(report.command), std::string::npos);
    EXPECT_NE(text.find("Number of Returns: number of tracked instants."), std::string::npos);
    EXPECT_NE(text.find("0.667"), std::string::npos);
  }
  EXPECT_NE(markdownReport(report).find("![plots/over view.png](<plots/over view.png>)"),
            std::string::npos);
}

TEST(Report, ABarInANameDoesNotBreakAMarkdownTable) {
  EvaluationReport report = sampleReport();
  report.runs[0].name = "a|b";
  EXPECT_NE(markdownReport(report).find("| a\\|b |"), std::string::npos);
}

TEST(Report, FrontsAreATableByClassAndMotion) {
  TrackedRun run = makeRun();
  SceneObject car = makeObject(1, 10, 0);
  car.p_front = 0.9;
  run.scenes = {makeScene(0, {car}), makeScene(1, {car})};
  std::vector<TruthObject> truth = {makeTruth(0, 5, 10, 0), makeTruth(1, 5, 10, 0)};
  for (TruthObject& t : truth) t.vx = t.vy = t.yaw = 0;
  EvaluationReport report;
  report.runs.push_back({"run", "run", evaluate(run, makeGroundTruth(truth), {}), {}});
  const auto tables = reportTables(report);
  const auto fronts = std::find_if(tables.begin(), tables.end(), [](const ReportTable& t) {
    return t.title == "Fronts of objects";
  });
  ASSERT_NE(fronts, tables.end());
  ASSERT_EQ(fronts->rows.size(), 4u) << "all and car, any motion and standing";
  EXPECT_EQ(fronts->rows[3], (std::vector<std::string>{"run", "car", "standing", "2", "1.000",
                                                       "1.000", "0.000", "n/a", "0.100"}));
  const auto json = nlohmann::json::parse(jsonReport(report))["runs"][0]["fronts"];
  ASSERT_EQ(json.size(), 4u);
  EXPECT_EQ(json[3]["motion"], "standing");
  EXPECT_EQ(json[3]["front_known"], 1);
}

TEST(Report, TextColumnsAreAlignedForNamesInUtf8) {
  EvaluationReport report = sampleReport();
  report.runs.push_back(report.runs[0]);
  report.runs[0].name =
      "Stra\xC3\x9F"
      "e";  // six letters, seven bytes
  report.runs[1].name = "street";
  const std::string text = textReport(report);
  const auto columnOf = [&](const std::string& name) {
    const std::size_t start = text.find("\n  " + name + " ") + 1;
    return text.find("0.667", start) - start;
  };
  EXPECT_EQ(columnOf(report.runs[0].name),
            columnOf(report.runs[1].name) + 1);  // the extra byte only
}

// A decimal comma for everything that asks the C++ locale, whatever locales the machine has.
struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(Report, TheLocaleChangesNothing) {
  const EvaluationReport report = sampleReport();
  const std::string before = textReport(report) + jsonReport(report);
  const std::locale old =
      std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  std::setlocale(LC_ALL, "de_DE.UTF-8");  // where it is installed, the C library's, too
  const std::string after = textReport(report) + jsonReport(report);
  std::locale::global(old);
  std::setlocale(LC_ALL, "C");
  EXPECT_EQ(before, after);
}

TEST(Report, CountsAgainstAReferenceAreATableOfTheirOwn) {
  EvaluationReport report = sampleReport();
  report.reference = "fifty_particles";
  report.runs[0].count_difference = CountDifference{3, 1.25, {}};
  bool found = false;
  for (const ReportTable& table : reportTables(report)) {
    if (table.header.size() < 2 || table.header[1] != "RMS Error: Number of Objects") continue;
    found = true;
    EXPECT_EQ(table.rows.at(0), (std::vector<std::string>{"first_run", "1.250", "n/a", "3"}));
  }
  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace perception
