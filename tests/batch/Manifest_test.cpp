#include "libperception/batch/Manifest.h"

#include "libperception/core/Error.h"
#include "tests/batch/BatchFixture.h"

namespace perception::test {
namespace {

struct Manifest : BatchFixture {
  void write() const {
    writeFile(dir + "/manifest.jsonl", manifestText(batch));
    writeFile(dir + "/batch.json", batchText(batch));
  }
  std::string fault() const {
    try {
      readBatch(dir);
    } catch (const DataError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(Manifest, IsReadAsItWasWritten) {
  addShard("a").seed = 18446744073709551615ULL;
  addShard("b").sensors = "C/H+R";
  batch.limits.memory = 2.5;
  batch.evaluation.selection.range = 30;
  write();
  const Batch read = readBatch(dir);
  EXPECT_EQ(manifestText(read), manifestText(batch));
  EXPECT_EQ(batchText(read), batchText(batch));
  EXPECT_EQ(read.shards[0].seed, batch.shards[0].seed);
  EXPECT_FALSE(read.shards[1].seed);
}

TEST_F(Manifest, ThatIsCutIsRefused) {
  addShard("a");
  addShard("b");
  write();
  const std::string text = manifestText(batch);
  writeFile(dir + "/manifest.jsonl", text.substr(0, text.find('\n') + 1));
  EXPECT_NE(fault().find("found 1 shards, expected 2"), std::string::npos) << fault();
  writeFile(dir + "/manifest.jsonl", text.substr(0, text.size() - 9));
  EXPECT_NE(fault().find("manifest.jsonl:2: found"), std::string::npos) << fault();
}

TEST_F(Manifest, WithAShardTwiceIsRefused) {
  addShard("a");
  addShard("a");
  write();
  EXPECT_NE(fault().find("manifest.jsonl:2: shard a is there twice"), std::string::npos) << fault();
}

TEST_F(Manifest, ThatIsNotThereSaysWhatToDo) {
  try {
    readBatch(dir);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_EQ(error.code(), ExitCode::kNoInput);
    EXPECT_NE(std::string(error.what()).find("perception-batch plan"), std::string::npos);
  }
}

TEST_F(Manifest, SettingsOfAShardAreInItsIniAndItsArguments) {
  Shard& shard = addShard("a");
  shard.sensors = "L";
  shard.seed = 12;
  shard.particles = 9;
  const std::string ini = effectiveIniOf(shard);
  for (const char* line : {"\nsensors = L ", "\nseed = 12 ", "\nsampleSize = 9 "})
    EXPECT_NE(ini.find(line), std::string::npos) << line;
  EXPECT_EQ(trackArguments(shard),
            (std::vector<std::string>{"-c", shard.config, "-i", "a.rawlog", "--sensors", "L",
                                      "--seed", "12", "--set", "particle_filter.sampleSize=9"}));
}

}  // namespace
}  // namespace perception::test
