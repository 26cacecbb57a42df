#include "studies/paper/PaperReport.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace perception {
namespace {

// So many of ten instants tracked, of a car or a pedestrian.
Evaluation evaluation(int tracked, ClassId kind) {
  Evaluation e;
  e.class_names = {"pedestrian", "car"};
  e.named = {true, true};
  for (std::size_t k = 0; k < 10; ++k) {
    e.instants.emplace_back();
    TruthSample sample;
    sample.instant = k;
    sample.id = 1;
    sample.class_id = kind;
    if (static_cast<int>(k) < tracked) sample.match[0] = sample.match[1] = Match{};
    e.samples.push_back(sample);
  }
  return e;
}

PaperOutcome outcome(const std::string& weather, int trial, int tracked, ClassId kind = 1) {
  PaperOutcome o;
  for (const PaperWeather& w : paperWeathers())
    if (w.name == weather) o.of = {"A", w, trial};
  o.runs["C+L+R"] = evaluation(tracked, kind);
  return o;
}

const StudyTable& tableOf(const std::vector<StudyTable>& tables, const std::string& name) {
  return *std::find_if(tables.begin(), tables.end(), [&](auto& t) { return t.name == name; });
}

std::vector<std::string> rowOf(const StudyTable& table, const std::string& first,
                               const std::string& sensors) {
  for (const auto& row : table.rows)
    if (row[0] == first && row[1] == sensors) return row;
  return {};
}

TEST(PaperReport, ThePapersNumberStandsBesideOursWithItsSpread) {
  const auto tables = paperTables({outcome("sunny", 1, 10), outcome("sunny", 2, 8)});
  const auto row = rowOf(tableOf(tables, "weather"), "Sunny", "C+L+R");
  ASSERT_EQ(row.size(), 14u);
  EXPECT_EQ(row[2], "0.900 ± 0.141");
  EXPECT_EQ(row[3], "0.998");
  EXPECT_EQ(row[12], "18");
  EXPECT_EQ(row[13], "1455");
}

TEST(PaperReport, AWeatherThatWasNotRunIsEmptyWithThePapersNumberAlone) {
  const auto tables = paperTables({outcome("sunny", 1, 10)});
  const auto row = rowOf(tableOf(tables, "weather"), "Snow & Rain", "C+L+R");
  ASSERT_EQ(row.size(), 14u);
  for (const std::size_t ours : {2, 4, 6, 8, 10, 12}) EXPECT_EQ(row[ours], "") << ours;
  EXPECT_EQ(row[3], "0.995");
}

TEST(PaperReport, KindsAreSeparate) {
  const auto tables = paperTables({outcome("night", 1, 10, 1), outcome("night", 1, 5, 0)});
  const StudyTable sensors = tableOf(tables, "sensors");
  EXPECT_EQ(rowOf(sensors, "Vehicle", "C+L+R")[2], "1.000");
  EXPECT_EQ(rowOf(sensors, "Pedestrian", "C+L+R")[2], "0.500");
  EXPECT_EQ(rowOf(sensors, "both", "C+L+R")[2], "0.750");
}

TEST(PaperReport, EightParticlesAreTheRunInSunAlone) {
  auto snow = outcome("snow_rain", 1, 3);
  auto sun = outcome("sunny", 1, 9);
  sun.runs[particlesName(1)] = evaluation(7, 1);
  const StudyTable table = tableOf(paperTables({snow, sun}), "particles");
  ASSERT_EQ(table.rows.size(), 3u);
  EXPECT_EQ(table.rows[0][2], "0.700");
  EXPECT_EQ(table.rows[0][3], "0.993");
  EXPECT_EQ(table.rows[1][2], "");
  EXPECT_EQ(table.rows[2][2], "0.900");
}

}  // namespace
}  // namespace perception
