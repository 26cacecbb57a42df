#include "libperception/batch/BatchPlan.h"

#include <sys/stat.h>

#include <set>

#include "libperception/core/Error.h"
#include "tests/batch/BatchFixture.h"

namespace perception::test {
namespace {

struct BatchPlan : testing::Test {
  TemporaryFolder folder;
  std::string ini = folder / "batch.ini", dir = folder / "batch";

  BatchPlan() {
    for (const char* log : {"b.rawlog", "a.rawlog"}) writeFile(folder / log, log);
    writeFile(folder / "site.ini",
              "include = " PERCEPTION_SOURCE_DIR "/ini/udacity.ini\n[run]\nseed = 4\n");
  }
  Batch plan(const std::string& text) const {
    writeFile(ini, text);
    Config config = Config::fromFile(ini);
    return planBatch(config, "1");
  }
  std::string fault(const std::string& text, ExitCode code) const {
    try {
      plan(text);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code) << error.what();
      return error.what();
    }
    return "";
  }
};

const std::string kBoth = "[batch]\nlogs = *.rawlog\nconfigs = site.ini\n";

TEST_F(BatchPlan, EveryLogMeetsEverySetting) {
  const Batch batch = plan(kBoth + "sensors = L, L+R\nparticles = 2, 3..4\nseeds = 1..2\n");
  ASSERT_EQ(batch.shards.size(), 2U * 2 * 3 * 2);
  std::set<std::string> ids;
  for (const Shard& shard : batch.shards) ids.insert(shard.id);
  EXPECT_EQ(ids.size(), batch.shards.size());
  EXPECT_EQ(batch.shards[0].input, folder / "a.rawlog");
  EXPECT_EQ(batch.shards[0].bytes, 8U);
  EXPECT_EQ(batch.shards[0].sensors, "L");
  EXPECT_EQ(batch.shards[0].particles, 2);
  EXPECT_EQ(batch.shards[1].seed, 2U);
  EXPECT_EQ(batch.shards.back().input, folder / "b.rawlog");
}

TEST_F(BatchPlan, EmptyListsLeaveTheConfigurationAsItIs) {
  const Batch batch = plan("[batch]\nlogs = a.rawlog, a.rawlog\nconfigs = site.ini\n");
  ASSERT_EQ(batch.shards.size(), 1U);  // a log that is named twice is one
  EXPECT_FALSE(batch.shards[0].seed);
  EXPECT_EQ(trackArguments(batch.shards[0]),
            (std::vector<std::string>{"-c", folder / "site.ini", "-i", folder / "a.rawlog"}));
}

TEST_F(BatchPlan, AnIdLastsWhenContentsChangeAndItsHashDoesNot) {
  const Shard before = plan(kBoth).shards[0];
  writeFile(folder / "a.rawlog", "other");
  const Shard after = plan(kBoth).shards[0];
  EXPECT_EQ(before.id, after.id);
  EXPECT_NE(before.runHash(), after.runHash());
  writeFile(folder / "site.ini",
            "include = " PERCEPTION_SOURCE_DIR "/ini/udacity.ini\n[run]\nseed = 5\n");
  EXPECT_NE(plan(kBoth).shards[0].runHash(), after.runHash());
}

TEST_F(BatchPlan, AllFaultsOfTheIniComeTogether) {
  const std::string text = fault(
      "[batch]\nconfigs = site.ini\nparticles = 2, x, 4..3\nseeds = -1\n[limits]\nmemori = 3\n",
      ExitCode::kBadConfig);
  for (const char* part : {"logs is needed", "found 'x'", "found '4..3'", "found '-1'", "memori"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
}

TEST_F(BatchPlan, AWrongSiteIniIsFoundBeforeAnyRun) {
  writeFile(folder / "site.ini", "[run]\nsed = 4\n");
  EXPECT_NE(fault(kBoth, ExitCode::kBadConfig).find("sed"), std::string::npos);
}

TEST_F(BatchPlan, LogsThatAreNoneAreFound) {
  EXPECT_NE(fault("[batch]\nlogs = none*.rawlog\nconfigs = site.ini\n", ExitCode::kNoInput)
                .find("none*.rawlog"),
            std::string::npos);
  ASSERT_EQ(::mkfifo((folder / "c.rawlog").c_str(), 0600), 0);  // reading it would wait for ever
  EXPECT_NE(fault(kBoth, ExitCode::kBadInput).find("c.rawlog: found a pipe"), std::string::npos);
}

TEST_F(BatchPlan, IsWrittenOnceAndNotReplacedByAnother) {
  const Batch first = plan(kBoth), other = plan(kBoth + "seeds = 7\n");
  EXPECT_TRUE(writeBatch(first, dir, false));
  EXPECT_FALSE(writeBatch(first, dir, false));
  try {
    writeBatch(other, dir, false);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::kBadConfig);
  }
  EXPECT_EQ(manifestText(readBatch(dir)), manifestText(first));
  EXPECT_TRUE(writeBatch(other, dir, true));
  EXPECT_EQ(manifestText(readBatch(dir)), manifestText(other));
}

}  // namespace
}  // namespace perception::test
