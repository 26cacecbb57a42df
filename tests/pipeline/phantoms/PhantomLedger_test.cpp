#include "libperception/pipeline/phantoms/PhantomLedger.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "libperception/core/Csv.h"
#include "tests/support/StartStamp.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

using test::kStart;

/// A scan with that many phantom clusters of 20 returns, all by shape.
LedgerRow rowAt(double t, std::size_t phantoms, const std::string& sensor = "LIDAR") {
  LedgerRow row{kStart + t, sensor, {}, ClusterLedger{}};
  row.trust.returns = 1000, row.trust.phantoms = 2, row.trust.weight_lost = 1.75;
  row.trust.doubts.add({DoubtCause::kIsolated, 1.5});
  row.trust.doubts.add({DoubtCause::kMirror, 0});
  row.clusters->clusters = phantoms + 10, row.clusters->suspicious = 1;
  row.clusters->returns = 20 * phantoms;
  row.clusters->probability = 0.9 * static_cast<double>(phantoms);
  row.clusters->phantoms[ClusterLedger::kByShape] = phantoms;
  return row;
}

std::vector<nlohmann::json> eventsOf(const EventLog& events, const std::string& kind) {
  std::vector<nlohmann::json> found;
  std::istringstream lines(events.text(kStart));
  for (std::string line; std::getline(lines, line);) {
    nlohmann::json event = nlohmann::json::parse(line);
    if (event["kind"] == kind) found.push_back(std::move(event));
  }
  return found;
}

TEST(ClusterLedger, TheCauseIsThatOfMostOfItsDoubtedReturns) {
  ClusterVerdicts verdicts;
  verdicts.clusters = 7, verdicts.suspicious = 2;
  verdicts.phantoms = {{10, 0.8, {1, 2, 3}}, {30, 0.9, {}}, {40, 1, {1, 2, 3}}};
  const ClusterLedger ledger = ClusterLedger::of(verdicts, [](std::uint32_t i) {
    return Doubt{i == 1 ? DoubtCause::kIsolated : DoubtCause::kIntensity, 1};
  });
  EXPECT_EQ(ledger.clusters, 7U);
  EXPECT_EQ(ledger.suspicious, 2U);
  EXPECT_EQ(ledger.total(), 3U);
  EXPECT_EQ(ledger.returns, 80U);
  EXPECT_NEAR(ledger.probability, 2.7, 1e-12);
  EXPECT_EQ(ledger.phantoms[static_cast<std::size_t>(DoubtCause::kIntensity)], 1U);
  EXPECT_EQ(ledger.phantoms[ClusterLedger::kByShape], 2U) << "no doubted return, and too few";
}

TEST(ClusterLedger, ReturnsThatNobodyDoubtsGiveNoCause) {
  ClusterVerdicts verdicts;
  verdicts.phantoms = {{3, 0.8, {1, 2, 3}}};
  const auto ledger = ClusterLedger::of(verdicts, [](std::uint32_t) { return std::nullopt; });
  EXPECT_EQ(ledger.phantoms[ClusterLedger::kByShape], 1U);
  EXPECT_STREQ(ClusterLedger::nameOf(ClusterLedger::kByShape), "shape");
  EXPECT_STREQ(ClusterLedger::nameOf(0), "isolated");
}

TEST(PhantomLedger, PhantomsBeginAtThreeAScanAndEndAtOne) {
  EventLog events;
  PhantomLedger ledger(events);
  const auto pass = [&](int from, int to, std::size_t phantoms) {
    for (int k = from; k < to; ++k) ledger.add(rowAt(0.1 * k, phantoms));
  };
  pass(0, 50, 2), pass(50, 100, 4), pass(100, 150, 2), pass(150, 200, 0);
  const auto begin = eventsOf(events, event_kind::kPhantomsBegin),
             end = eventsOf(events, event_kind::kPhantomsEnd);
  ASSERT_EQ(begin.size(), 1U);
  ASSERT_EQ(end.size(), 1U) << "two a scan end nothing";
  EXPECT_NEAR(begin[0]["t"].get<double>(), 5.9, 1e-9) << "half of the window has four";
  EXPECT_NEAR(end[0]["t"].get<double>(), 15.9, 1e-9);
  EXPECT_EQ(begin[0]["fields"]["sensor"], "LIDAR");
  EXPECT_EQ(begin[0]["fields"]["cause"], "shape");
  EXPECT_EQ(begin[0]["fields"]["per_scan"], 3);
  EXPECT_EQ(end[0]["fields"]["per_scan"], 1);
  EXPECT_EQ(events.warnings(), 0U);
}

TEST(PhantomLedger, TheCauseOfTheEventIsThatOfMostClusters) {
  EventLog events;
  PhantomLedger ledger(events);
  for (int k = 0; k < 30; ++k) {
    LedgerRow row = rowAt(0.1 * k, 2);
    row.clusters->phantoms[static_cast<std::size_t>(DoubtCause::kAmongPhantoms)] = 6;
    ledger.add(row);
  }
  const auto begin = eventsOf(events, event_kind::kPhantomsBegin);
  ASSERT_EQ(begin.size(), 1U);
  EXPECT_EQ(begin[0]["fields"]["cause"], "among_phantoms");
  EXPECT_EQ(begin[0]["fields"]["share"], 0.75);
}

TEST(PhantomLedger, FewScansAndScansAfterAGapAreNoTwoSeconds) {
  EventLog events;
  PhantomLedger ledger(events);
  for (int part = 0; part < 4; ++part)
    for (int k = 0; k < 20; ++k) ledger.add(rowAt(10 * part + 0.1 * k, 9));
  for (int k = 0; k < 20; ++k) ledger.add(rowAt(0.1 * k, 9));  // the clock went back
  EXPECT_TRUE(events.counts().empty());
  ledger.add(rowAt(2, 9));
  EXPECT_EQ(events.counts().at(event_kind::kPhantomsBegin), 1U);
}

TEST(PhantomLedger, LidarsAreWatchedEachForItself) {
  EventLog events;
  PhantomLedger ledger(events);
  for (int k = 0; k < 40; ++k)
    ledger.add(rowAt(0.1 * k, 9, "A")), ledger.add(rowAt(0.1 * k, 0, "B"));
  const auto begin = eventsOf(events, event_kind::kPhantomsBegin);
  ASSERT_EQ(begin.size(), 1U);
  EXPECT_EQ(begin[0]["fields"]["sensor"], "A");
  EXPECT_EQ(begin[0]["fields"]["per_scan"], 9);
}

TEST(PhantomLedger, TheRunEndsWithItsTotalsByCauseAndSensor) {
  EventLog events;
  PhantomLedger ledger(events);
  for (int k = 0; k < 3; ++k) ledger.add(rowAt(k, 2, "A"));
  LedgerRow plain = rowAt(3, 0, "B");
  plain.clusters.reset();
  ledger.add(plain);
  ledger.finish();
  const auto totals = eventsOf(events, event_kind::kPhantoms);
  ASSERT_EQ(totals.size(), 1U);
  EXPECT_EQ(totals[0]["t"], 3) << "the last scan";
  const auto& a = totals[0]["fields"]["A"];
  EXPECT_EQ(a["scans"], 3);
  EXPECT_EQ(a["returns"], 3000);
  EXPECT_EQ(a["weight_lost"], 5.25);
  EXPECT_EQ(a["doubted"]["isolated"]["returns"], 3);
  EXPECT_EQ(a["doubted"]["isolated"]["log_odds"], 1.5);
  EXPECT_EQ(a["doubted"]["mirror"]["returns"], 3);
  EXPECT_FALSE(a["doubted"].contains("echo"));
  EXPECT_EQ(a["clusters"]["judged"], 36);
  EXPECT_EQ(a["clusters"]["suspicious"], 3);
  EXPECT_EQ(a["clusters"]["phantoms"], 6);
  EXPECT_EQ(a["clusters"]["returns"], 120);
  EXPECT_EQ(a["clusters"]["probability"], 0.9);
  EXPECT_EQ(a["clusters"]["causes"]["shape"], 6);
  EXPECT_FALSE(totals[0]["fields"]["B"].contains("clusters")) << "not told by their shape";
}

TEST(PhantomLedger, WithoutScansThereIsNoEvent) {
  EventLog events;
  PhantomLedger ledger(events);
  ledger.finish();
  EXPECT_TRUE(events.counts().empty());
  EXPECT_TRUE(ledger.take().empty());
}

TEST(PhantomLedger, TheFileHasALineAScan) {
  EventLog events;
  PhantomLedger ledger(events);
  ledger.add(rowAt(0.5, 4)), ledger.add(rowAt(0.6, 0));
  LedgerRow plain = rowAt(0.7, 0);
  plain.clusters.reset();
  ledger.add(plain);
  const test::TemporaryFolder folder;
  LedgerFile file(folder / "ledger.csv", kStart);
  for (const LedgerRow& row : ledger.take()) file.write(row);
  file.close();
  EXPECT_TRUE(ledger.take().empty());
  const CsvTable table = CsvTable::fromFile(folder / "ledger.csv");
  ASSERT_EQ(table.rows(), 3U);
  EXPECT_NEAR(table.real(0, table.column("t")), 0.5, 1e-9);
  EXPECT_EQ(table.text(0, table.column("sensor")), "LIDAR");
  const std::pair<const char*, std::size_t> numbers[] = {
      {"returns", 1000},    {"isolated", 1},   {"mirror", 1},           {"echo", 0},
      {"clusters", 14},     {"suspicious", 1}, {"phantom_clusters", 4}, {"phantom_returns", 80},
      {"clusters_shape", 4}};
  for (const auto& [name, value] : numbers)
    EXPECT_EQ(table.natural(0, table.column(name)), value) << name;
  EXPECT_NEAR(table.real(0, table.column("weight_lost")), 1.75, 1e-9);
  EXPECT_NEAR(table.real(0, table.column("phantom_p")), 0.9, 1e-9);
  EXPECT_EQ(table.text(1, table.column("phantom_p")), "") << "no phantom";
  for (const char* name : {"clusters", "phantom_clusters", "clusters_shape"})
    EXPECT_EQ(table.text(2, table.column(name)), "") << "not told by their shape";
}

}  // namespace
}  // namespace perception
