#include "libperception/batch/Completeness.h"

#include "tests/batch/BatchFixture.h"

namespace perception::test {
namespace {

struct ShardStates : BatchFixture {
  Shard shard = addShard("a");
  ShardState state() const { return statusOf(shard, dir).state; }
};

TEST_F(ShardStates, AreReadFromTheFolderOfTheBatch) {
  EXPECT_EQ(state(), ShardState::kMissing);
  std::filesystem::create_directories(dir + "/a/.unfinished.host.1");
  EXPECT_EQ(state(), ShardState::kMissing);
  writeFailure(shard, dir, ExitCode::kBadInput, "torn");
  EXPECT_EQ(state(), ShardState::kFailed);
  EXPECT_EQ(statusOf(shard, dir).reason, "torn");
  EXPECT_EQ(statusOf(shard, dir).code, ExitCode::kBadInput);
  finish(shard, recordOf(shard, {"one"}));
  EXPECT_EQ(state(), ShardState::kWarnings);  // a result counts more than an earlier failure
  finish(shard, recordOf(shard));
  EXPECT_EQ(state(), ShardState::kDone);
}

TEST_F(ShardStates, AResultOfOtherInputsIsStale) {
  finish(shard, recordOf(shard));
  shard.config_sha = "other";
  EXPECT_EQ(state(), ShardState::kStale);
  writeFile(dir + "/a/done.json", "{}");
  EXPECT_EQ(state(), ShardState::kStale);
}

TEST_F(ShardStates, AFailureOfOtherInputsIsForgotten) {
  writeFailure(shard, dir, ExitCode::kBadInput, "torn");
  shard.sha256 = "other";
  EXPECT_EQ(state(), ShardState::kMissing);
}

TEST_F(ShardStates, AreCountedAndFailuresSayTheirReason) {
  addShard("b");
  writeFailure(shard, dir, ExitCode::kInternal, "ended by signal 11");
  const Completeness c = completenessOf(batch, dir);
  EXPECT_FALSE(c.complete());
  EXPECT_EQ(completenessTable(batch, c),
            "2 shards, 1 failed, 1 missing\na a.rawlog failed: code 70: ended by signal 11\n");
}

TEST_F(ShardStates, OnlyWhatTheMachineMendsIsWorthARetry) {
  for (const int code : {66, 69, 73, 74, 75}) EXPECT_TRUE(isWorthRetry(ExitCode{code})) << code;
  for (const int code : {64, 65, 70, 78}) EXPECT_FALSE(isWorthRetry(ExitCode{code})) << code;
}

}  // namespace
}  // namespace perception::test
