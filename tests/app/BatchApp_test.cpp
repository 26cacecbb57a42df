#include "libperception/app/BatchApp.h"

#include <chrono>
#include <cstdlib>
#include <map>
#include <thread>

#include "tests/app/LogFaults.h"

namespace perception::test {
namespace {

const std::string kTrack = PERCEPTION_BINARY_DIR "/bin/perception-track";

/// A batch of the demo's first seconds.
struct BatchOfDemo : testing::Test {
  TemporaryFolder folder;
  std::string dir = folder / "batch";
  BatchApp last;

  BatchOfDemo() { writeLog(demoStart(1.5), folder / "a.rawlog"); }

  void writeIni(const std::string& more) const {
    std::ofstream(folder / "batch.ini")
        << "[batch]\nlogs = *.rawlog\nconfigs = " << kDemoIni << "\n"
        << more;
  }
  Ended call(const std::string& task, std::vector<std::string> options = {}) {
    options.insert(options.begin(), {task, "-o", dir});
    last = {};
    last.track_program = kTrack;
    return runProgram(last, options);
  }
  Ended plan(std::vector<std::string> options = {}) {
    options.insert(options.begin(), {"-c", folder / "batch.ini"});
    return call("plan", options);
  }
  std::size_t count(ShardState state) const { return last.out_completeness.count(state); }
  /// Files below a folder of the batch and their contents, without those that hold run times.
  std::map<std::string, std::string> filesIn(const std::string& where) const {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(where)) {
      const auto name = entry.path().filename();
      if (entry.is_regular_file() && name != "timing.json" && name != "timing.csv")
        files[entry.path().lexically_relative(where).string()] = contentOf(entry.path().string());
    }
    return files;
  }
};

TEST_F(BatchOfDemo, AShardIsTheSameRunOfPerceptionTrack) {
  writeIni("sensors = L\nparticles = 3\nseeds = 5\n");
  ASSERT_EQ(plan().code, 0);
  ASSERT_EQ(call("run", {"--jobs", "1"}).code, 0);
  TrackApp track;
  ASSERT_EQ(
      runProgram(track, {"-c", kDemoIni, "-i", folder / "a.rawlog", "-o", folder / "alone",
                         "--sensors", "L", "--seed", "5", "--set", "particle_filter.sampleSize=3"})
          .code,
      0);
  const std::string id = readBatch(dir).shards.at(0).id;
  const auto files = filesIn(dir + "/" + id);
  EXPECT_GE(files.size(), 5U);
  EXPECT_EQ(files, filesIn(folder / "alone"));
}

TEST_F(BatchOfDemo, GivesTheSameBytesInAnyOrderAndASecondRunChangesNothing) {
  writeIni("sensors = L, C+L\nseeds = 1..2\n");
  ASSERT_EQ(plan().code, 0);
  ASSERT_EQ(call("run", {"--jobs", "2"}).code, 0);
  ASSERT_EQ(call("reduce").code, 0);
  const auto before = filesIn(dir);
  const auto page =
      std::filesystem::last_write_time(dir + "/" + readBatch(dir).shards[0].id + "/done.json");
  ASSERT_EQ(call("run").code, 0);
  EXPECT_EQ(
      std::filesystem::last_write_time(dir + "/" + readBatch(dir).shards[0].id + "/done.json"),
      page);
  ASSERT_EQ(call("reduce").code, 0);
  EXPECT_EQ(filesIn(dir), before);
  dir = folder / "again";
  ASSERT_EQ(plan().code, 0);
  for (const char* index : {"3", "1", "0", "2"})
    ASSERT_EQ(call("run", {"--index", index}).code, 0) << index;
  ASSERT_EQ(call("reduce").code, 0);
  for (const char* file : {"shards.csv", "batch.sqlite", "index.html", "manifest.jsonl"})
    EXPECT_EQ(contentOf(dir + "/" + file), before.at(file)) << file;
}

TEST_F(BatchOfDemo, ABadLogCostsItsOwnShards) {
  const std::string whole = contentOf(folder / "a.rawlog");
  std::ofstream(folder / "junk.rawlog") << "no rawlog";
  std::ofstream(folder / "torn.rawlog") << whole.substr(0, whole.size() / 2);
  writeIni("sensors = L\n");
  ASSERT_EQ(plan().code, 0);
  EXPECT_EQ(call("run").code, 3);
  EXPECT_EQ(count(ShardState::kDone), 1U);
  EXPECT_EQ(count(ShardState::kWarnings), 1U);
  EXPECT_EQ(count(ShardState::kFailed), 1U);
  EXPECT_EQ(call("run", {"--index", "1"}).code, 65);  // by the manifest: a, junk, torn
  EXPECT_NE(last.out_completeness.shards[1].reason.find("junk.rawlog"), std::string::npos);
  EXPECT_EQ(call("run", {"--index", "2"}).code, 3);
  EXPECT_EQ(call("reduce").code, 3);
  EXPECT_NE(contentOf(dir + "/shards.csv").find("junk.rawlog"), std::string::npos);
}

TEST_F(BatchOfDemo, ReduceSaysWhatIsMissing) {
  writeIni("sensors = L\nseeds = 1..2\n");
  ASSERT_EQ(plan().code, 0);
  ASSERT_EQ(call("run", {"--index", "1"}).code, 0);
  EXPECT_EQ(call("status").code, 3);
  EXPECT_EQ(count(ShardState::kMissing), 1U);
  EXPECT_EQ(call("reduce").code, 3);
  EXPECT_NE(contentOf(dir + "/shards.csv").find(",missing,"), std::string::npos);
}

TEST_F(BatchOfDemo, FiguresComeFromTheTruthBesideTheLog) {
  std::filesystem::copy_file(PERCEPTION_SOURCE_DIR "/rawlogs/demo.truth.csv",
                             folder / "a.truth.csv");
  writeIni("sensors = L\n");
  ASSERT_EQ(plan().code, 0);
  ASSERT_EQ(call("run").code, 0);
  ASSERT_EQ(call("reduce").code, 0);
  const std::string csv = contentOf(dir + "/shards.csv");
  EXPECT_NE(csv.substr(0, csv.find('\n')).find(",closest.all.object_tracked_a,"),
            std::string::npos);
  EXPECT_NE(contentOf(dir + "/index.html").find("simulated results"), std::string::npos);
}

TEST_F(BatchOfDemo, TheSchedulersNumberIsTheIndex) {
  writeIni("sensors = L\nseeds = 1..2\n");
  ASSERT_EQ(plan().code, 0);
  ::setenv("JOB_COMPLETION_INDEX", "1", 1);
  const int code = call("run").code;
  ::setenv("JOB_COMPLETION_INDEX", "2", 1);
  const int beyond = call("run").code;
  ::unsetenv("JOB_COMPLETION_INDEX");
  EXPECT_EQ(code, 0);
  EXPECT_EQ(beyond, 64);
  call("status");
  EXPECT_EQ(last.out_completeness.shards[0].state, ShardState::kMissing);
  EXPECT_EQ(last.out_completeness.shards[1].state, ShardState::kDone);
}

TEST_F(BatchOfDemo, RelativePathsStartWhereTheBatchWasPlanned) {
  writeIni("sensors = L\n");
  {
    const WorkingFolder working(folder.path());
    dir = "batch";
    last = {};
    ASSERT_EQ(runProgram(last, {"plan", "-o", dir, "-c", "batch.ini"}).code, 0);
  }
  dir = folder / "batch";
  EXPECT_EQ(readBatch(dir).shards.at(0).input, "a.rawlog");
  EXPECT_EQ(call("run").code, 0);
  EXPECT_EQ(call("reduce").code, 0);
}

TEST_F(BatchOfDemo, AChangedPlanReplacesRunsOnlyWhenAsked) {
  writeIni("sensors = L\n");
  ASSERT_EQ(plan().code, 0);
  ASSERT_EQ(call("run").code, 0);
  writeLog(demoStart(1), folder / "a.rawlog");
  EXPECT_EQ(plan().code, 78);
  EXPECT_EQ(plan({"--overwrite"}).code, 0);
  EXPECT_EQ(call("reduce").code, 65);  // figures of another log
  EXPECT_EQ(call("run").code, 78);
  EXPECT_EQ(call("run", {"--overwrite"}).code, 0);
  EXPECT_EQ(call("reduce").code, 0);
}

TEST_F(BatchOfDemo, SlurmGivesTheSameBytes) {
  if (std::system("sinfo --noheader >/dev/null 2>&1") != 0) GTEST_SKIP() << "no Slurm answers";
  writeIni("sensors = L\nseeds = 1..3\n");
  ASSERT_EQ(plan().code, 0);
  ASSERT_EQ(call("submit").code, 0);
  EXPECT_EQ(last.out_jobs.size(), 2U);
  EXPECT_EQ(call("submit").code, 0);
  EXPECT_TRUE(last.out_jobs.empty());  // all wait or run already
  constexpr auto kLongest = std::chrono::minutes(3);
  const auto start = std::chrono::steady_clock::now();
  while (!std::filesystem::exists(dir + "/index.html") &&
         std::chrono::steady_clock::now() - start < kLongest)
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  const auto queued = filesIn(dir);
  dir = folder / "here";
  ASSERT_EQ(plan().code, 0);
  ASSERT_EQ(call("run").code, 0);
  ASSERT_EQ(call("reduce").code, 0);
  for (const auto& [name, content] : filesIn(dir)) {
    if (name.rfind("log/", 0) == 0) continue;  // names of folders, run times
    ASSERT_EQ(queued.count(name), 1U) << name;
    EXPECT_EQ(queued.at(name), content) << name;
  }
}

TEST_F(BatchOfDemo, FaultsHaveTheirCodes) {
  EXPECT_EQ(call("run").code, 66);  // nothing planned
  EXPECT_EQ(call("status").code, 66);
  EXPECT_EQ(call("").code, 64);
  writeIni("seeds = x\n");
  EXPECT_EQ(plan().code, 78);
  EXPECT_FALSE(std::filesystem::exists(dir));
}

TEST_F(BatchOfDemo, TheShippedIniPlans) {
  last = {};
  ASSERT_EQ(
      runProgram(last, {"plan", "-o", dir, "-c", PERCEPTION_SOURCE_DIR "/ini/batch.ini"}).code, 0);
  EXPECT_EQ(readBatch(dir).shards.size(), 12U);
}

}  // namespace
}  // namespace perception::test
