#include "libperception/batch/BatchRun.h"

#include <csignal>
#include <map>
#include <numeric>

#include "libperception/core/system/MemoryLimit.h"
#include "libperception/pipeline/output/Progress.h"
#include "tests/batch/BatchFixture.h"

namespace perception::test {
namespace {

struct RunsOfABatch : BatchFixture {
  BatchRunOptions options;
  std::vector<std::string> order;

  RunsOfABatch() { options.jobs = 2; }
  /// Runs all that is pending; what became of each, by id.
  std::map<std::string, ShardStatus> run(const std::string& script) {
    options.program = program(script);
    std::vector<std::size_t> all(batch.shards.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    std::map<std::string, ShardStatus> ended;
    BatchRun runner(batch, dir, options);
    runner.run(runner.pending(all), [&](const Shard& shard, const ShardStatus& status, double) {
      ended[shard.id] = status;
      order.push_back(shard.id);
    });
    return ended;
  }
  void expectAllButOneDone(const std::map<std::string, ShardStatus>& ended, const char* bad) {
    EXPECT_EQ(ended.size(), batch.shards.size());
    for (const auto& [id, status] : ended) EXPECT_EQ(status.hasResult(), id != bad) << id;
  }
};

TEST_F(RunsOfABatch, FinishedShardsAreLeftAlone) {
  addShard("a");
  addShard("b");
  EXPECT_EQ(run("finish").size(), 2U);
  EXPECT_TRUE(run("exit 70").empty());
  EXPECT_TRUE(completenessOf(batch, dir).clean());
}

TEST_F(RunsOfABatch, LargeLogsComeFirst) {
  options.jobs = 1;
  addShard("a", 5);
  addShard("b", 7);
  run("finish");
  EXPECT_EQ(order, (std::vector<std::string>{"b", "a"}));
}

TEST_F(RunsOfABatch, ACrashCostsItsOwnShard) {
  for (const char* id : {"a", "bad", "c"}) addShard(id);
  auto ended = run("[ $id = bad ] && kill -SEGV $$; finish");
  expectAllButOneDone(ended, "bad");
  EXPECT_EQ(ended["bad"].code, ExitCode::kInternal);
  EXPECT_NE(ended["bad"].reason.find("signal 11"), std::string::npos) << ended["bad"].reason;
}

TEST_F(RunsOfABatch, ALoopCostsItsOwnShardAndTheLimitOfProcessorTime) {
  batch.limits.time = 2;
  for (const char* id : {"a", "bad", "c"}) addShard(id);
  auto ended = run("[ $id = bad ] && { trap '' TERM; while :; do :; done; }; finish");
  expectAllButOneDone(ended, "bad");
  EXPECT_EQ(ended["bad"].code, ExitCode::kBadInput);
  EXPECT_EQ(ended["bad"].reason, "took more than 2 s of processor time");
}

TEST_F(RunsOfABatch, OneThatWaitsForEverCostsItsOwnShardAndMayBeTriedAgain) {
  batch.limits.time = 0.5;
  for (const char* id : {"a", "bad", "c"}) addShard(id);
  const auto start = std::chrono::steady_clock::now();
  auto ended = run("[ $id = bad ] && { trap '' TERM; sleep 100; sleep 100; }; finish");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(12));
  expectAllButOneDone(ended, "bad");
  EXPECT_EQ(ended["bad"].code, ExitCode::kUnavailable);
  EXPECT_EQ(ended["bad"].reason, "did not end within 4 s");
}

TEST_F(RunsOfABatch, MemoryIsLimited) {
  if (!MemoryLimit::supported()) GTEST_SKIP() << "no memory limit beneath this sanitizer";
  batch.limits.memory = 1;
  for (const char* id : {"a", "bad", "c"}) addShard(id);
  // tail keeps what has no line end: 2 GB.
  auto ended =
      run("[ $id = bad ] && { head -c 2000000000 /dev/zero | tail -n 1 >/dev/null || exit 70; }\n"
          "finish");
  expectAllButOneDone(ended, "bad");
  EXPECT_EQ(ended["bad"].code, ExitCode::kInternal);
}

TEST_F(RunsOfABatch, WhatFailsForGoodIsNotRunAgainUnlessAsked) {
  addShard("a");
  EXPECT_EQ(run("echo 'track: error: a.rawlog: torn' >&2; exit 65")["a"].reason, "a.rawlog: torn");
  EXPECT_EQ(contentOf(dir + "/log/a.log"), "track: error: a.rawlog: torn\n");
  EXPECT_TRUE(run("finish").empty());
  options.retry = true;
  EXPECT_TRUE(run("finish")["a"].hasResult());
  EXPECT_FALSE(std::filesystem::exists(dir + "/failed/a.json"));
}

TEST_F(RunsOfABatch, AFullDiskIsTriedAgain) {
  addShard("a");
  EXPECT_EQ(run("exit 74")["a"].code, ExitCode::kIoError);
  EXPECT_TRUE(run("finish")["a"].hasResult());
}

TEST_F(RunsOfABatch, AnInterruptedShardIsMissingNotFailed) {
  addShard("a");
  for (const char* end : {"exit 75", "kill -TERM $$", "kill -KILL $$"})
    EXPECT_EQ(run(end)["a"].state, ShardState::kMissing) << end;
  EXPECT_EQ(completenessOf(batch, dir).count(ShardState::kMissing), 1U);
}

TEST_F(RunsOfABatch, AStaleShardIsRefusedUnlessItMayBeReplaced) {
  const Shard shard = addShard("a");
  RunRecord other = recordOf(shard);
  other.hash = "other";
  finish(shard, other);
  try {
    run("finish");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::kBadConfig);
  }
  options.overwrite = true;
  EXPECT_TRUE(run("finish")["a"].hasResult());
}

TEST_F(RunsOfABatch, AConfigurationThatChangedSinceThePlanIsRefused) {
  addShard("a").config_sha = "other";
  try {
    run("finish");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::kBadConfig);
    EXPECT_NE(std::string(error.what()).find("has changed"), std::string::npos);
  }
}

TEST_F(RunsOfABatch, ALogThatChangedSinceThePlanHasFailed) {
  const Shard shard = addShard("a");
  options.program = program("finish");
  RunRecord other = recordOf(shard);
  other.hash = "other";
  keepRecord(shard, other);
  BatchRun runner(batch, dir, options);
  ShardStatus ended;
  runner.run({0}, [&](const Shard&, const ShardStatus& status, double) { ended = status; });
  EXPECT_EQ(ended.state, ShardState::kFailed);
  EXPECT_EQ(ended.code, ExitCode::kBadConfig);
}

TEST_F(RunsOfABatch, AProgramThatIsNotThereIsUnavailable) {
  addShard("a");
  options.program = folder / "none";
  BatchRun runner(batch, dir, options);
  ShardStatus ended;
  runner.run({0}, [&](const Shard&, const ShardStatus& status, double) { ended = status; });
  EXPECT_EQ(ended.code, ExitCode::kUnavailable);
}

TEST_F(RunsOfABatch, ASignalStopsAllWithinSeconds) {
  for (const char* id : {"a", "b", "c"}) addShard(id);
  const StopSignals listening;
  std::raise(SIGTERM);
  const auto start = std::chrono::steady_clock::now();
  try {
    run("sleep 100; finish");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::kTryAgain);
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
  EXPECT_EQ(completenessOf(batch, dir).count(ShardState::kFailed), 0U);
}

}  // namespace
}  // namespace perception::test
