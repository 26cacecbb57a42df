#include "libperception/scene/files/RunTiming.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

namespace perception {
namespace {

TEST(RunTiming, SumsTheCallsOfAStage) {
  RunTiming timing;
  timing.add("lidar", 0.25);
  timing.add("filter", 1);
  timing.add("lidar", 0.5);
  const auto stages = timing.stages();
  ASSERT_EQ(stages.size(), 2u);
  EXPECT_EQ(stages[0].name, "lidar");
  EXPECT_EQ(stages[0].calls, 2u);
  EXPECT_DOUBLE_EQ(stages[0].seconds, 0.75);
  EXPECT_DOUBLE_EQ(stages[0].longest, 0.5);
}

TEST(RunTiming, AScopeMeasuresItsLifeAndThreadsMayShareAStage) {
  RunTiming timing;
  const auto sleep = [&] {
    const auto scope = timing.stage("sleep");
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  };
  std::thread other(sleep);
  sleep();
  other.join();
  ASSERT_EQ(timing.stages().size(), 1u);
  EXPECT_EQ(timing.stages()[0].calls, 2u);
  EXPECT_GE(timing.stages()[0].seconds, 0.04);
  EXPECT_GE(timing.wallSeconds(), timing.stages()[0].longest);
}

TEST(RunTiming, TheCurrentStageIsTheLastBegunOfThoseThatHaveNotEnded) {
  RunTiming timing;
  std::optional<RunTiming::Scope> filter, grid;
  EXPECT_EQ(timing.current(), "");
  filter.emplace(timing, "filter");
  grid.emplace(timing, "grid");
  EXPECT_EQ(timing.current(), "grid");
  filter.reset();  // of two threads the first to begin may be the first to end
  EXPECT_EQ(timing.current(), "grid");
  grid.reset();
  EXPECT_EQ(timing.current(), "");
  EXPECT_EQ(timing.changes(), 4u);
}

TEST(RunTiming, CountsWorkAsCpuTimeAndNotSleep) {
  RunTiming timing;
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  const double asleep = timing.cpuSeconds();
  EXPECT_LT(asleep, 0.025);
  while (timing.cpuSeconds() < asleep + 0.02) {
  }
  EXPECT_GE(timing.cpuSeconds(), 0.02);
}

TEST(RunTiming, ReportsTheRealTimeFactorAndMemory) {
  RunTiming timing;
  timing.add("lidar", 0.5);
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const auto report = nlohmann::json::parse(timing.toJson(10, 4));
  EXPECT_EQ(report["threads"], 4);
  EXPECT_EQ(report["log_seconds"], 10.0);
  EXPECT_GT(report["real_time_factor"], 1.0);
  EXPECT_LE(report["real_time_factor"], 1000.0);
  EXPECT_GT(report["peak_memory_bytes"], 1000000);
  EXPECT_EQ(report["stages"][0]["name"], "lidar");
}

TEST(RunTiming, LatenciesAreGivenByTheirQuantiles) {
  RunTiming timing;
  EXPECT_EQ(timing.toJson(1, 1).find("latency"), std::string::npos);
  for (int i = 1; i <= 1000; ++i) timing.addLatency(1e-4 * i);
  const auto latency = nlohmann::json::parse(timing.toJson(1, 1)).at("latency");
  EXPECT_EQ(latency.at("scenes"), 1000);
  EXPECT_NEAR(latency.at("p50_seconds"), 0.050, 0.0011);  // 2 % of bins
  EXPECT_NEAR(latency.at("p99_seconds"), 0.099, 0.0021);
  EXPECT_NEAR(latency.at("longest_seconds"), 0.1, 1e-9);
}

TEST(RunTiming, LatenciesOfSecondsAndMinutesAreNotCutOff) {
  RunTiming timing;
  for (int i = 1; i <= 1000; ++i) timing.addLatency(1e-2 * i);
  const auto latency = nlohmann::json::parse(timing.toJson(1, 1)).at("latency");
  EXPECT_NEAR(latency.at("p50_seconds"), 5.0, 0.11);
  EXPECT_NEAR(latency.at("p99_seconds"), 9.9, 0.21);
  RunTiming stalled;
  for (const double seconds : {0.1, 200.0, 300.0}) stalled.addLatency(seconds);
  EXPECT_NEAR(nlohmann::json::parse(stalled.toJson(1, 1)).at("latency").at("p99_seconds"), 300.0,
              1e-9);
}

}  // namespace
}  // namespace perception
