#include "libperception/batch/BatchResults.h"

#include <sqlite3.h>

#include <algorithm>

#include "libperception/batch/BatchDatabase.h"
#include "libperception/batch/BatchPage.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/tables/Report.h"
#include "libperception/scene/files/TrackedRun.h"
#include "tests/batch/BatchFixture.h"
#include "tests/evaluation/MakeRun.h"

namespace perception::test {
namespace {

/// Two shards are done, one of them with truth; one failed, one is missing.
struct Results : BatchFixture {
  Results() {
    for (const char* id : {"d", "c", "b", "a"}) addShard(id);
    for (Shard& shard : batch.shards) shard.input = folder / shard.input;
    for (const char* id : {"a", "b"}) track(shardOf(id));
    std::vector<TruthObject> truth;
    for (int frame = 0; frame < 4; ++frame)
      truth.push_back(testing_evaluation::makeTruth(frame, 1, 10, 0));
    writeGroundTruth(folder / "a.truth.csv", truth);
    writeFailure(shardOf("c"), dir, ExitCode::kBadInput, "torn, \"cut\" </script>");
  }
  const Shard& shardOf(const std::string& id) const {
    return *std::find_if(batch.shards.begin(), batch.shards.end(),
                         [&](const Shard& s) { return s.id == id; });
  }
  /// A car is output in three of the four scenes.
  void track(const Shard& shard) const {
    finish(shard, recordOf(shard));
    const std::string at = dir + "/" + shard.id;
    std::string tracks =
        "frame,t,stamp,id,class,classified,p_pedestrian,p_car,p_static-other,existence,x,y,z,yaw,"
        "has_yaw,p_front,vx,vy,speed,length,width,height,sd_x,sd_y,sd_yaw,sd_speed,last_hit_C,last_"
        "hit_L,"
        "last_hit_R\n";
    std::string scenes =
        "frame,t,stamp,x,y,z,yaw,pitch,roll,vx,vy,yaw_rate,objects,free_distance,free_seen,stop,"
        "obstacle\n";
    for (int frame = 0; frame < 4; ++frame) {
      const std::string when = std::to_string(frame) + ",0." + std::to_string(frame) +
                               "00000000,100" + "0." + std::to_string(frame) + "00000000";
      const bool seen = frame > 0;
      scenes += when + ",0,0,0,0,0,0,0,0,0," + (seen ? "1" : "0") + ",,,,\n";
      if (seen)
        tracks +=
            when + ",1,car,1,0.01,0.98,0.01,0.9,10,0,0,0,1,0.5,0,0,0,4,2,1.5,0.1,0.1,0.1,0.1,,0,\n";
    }
    writeFile(at + "/tracks.csv", tracks);
    writeFile(at + "/scenes.csv", scenes);
    writeFile(at + "/timing.json", "{\"wall_seconds\": 2.5, \"cpu_seconds\": 2}");
  }
  /// The first value that a query gives, as text.
  std::string query(const std::string& file, const std::string& sql) const {
    sqlite3* db = nullptr;
    EXPECT_EQ(sqlite3_open(file.c_str(), &db), SQLITE_OK);
    std::string value = "none";
    const auto take = [](void* to, int, char** cells, char**) {
      *static_cast<std::string*>(to) = cells[0] ? cells[0] : "null";
      return 1;
    };
    sqlite3_exec(db, sql.c_str(), take, &value, nullptr);
    sqlite3_close(db);
    return value;
  }
};

TEST_F(Results, HaveTheFiguresOfTheEvaluation) {
  const BatchResults results = batchResults(batch, dir);
  ASSERT_EQ(results.shards.size(), 4U);
  EXPECT_EQ(results.shards[0].shard.id, "a");  // by id, however the manifest has them
  ASSERT_TRUE(results.shards[0].figure("closest.all.object_tracked_a"))
      << results.shards[0].evaluation_fault;
  EXPECT_DOUBLE_EQ(*results.shards[0].figure("closest.all.object_tracked_a"), 0.75);
  EXPECT_EQ(*results.shards[0].figure("closest.all.active"), 4);
  EXPECT_TRUE(results.shards[1].figures.empty());  // no truth
  EXPECT_EQ(results.shards[1].status.state, ShardState::kDone);
  EXPECT_EQ(results.shards[2].status.state, ShardState::kFailed);
  EXPECT_EQ(results.shards[3].status.state, ShardState::kMissing);
}

TEST_F(Results, OfAnotherVersionAreRefused) {
  RunRecord other = recordOf(shardOf("b"));
  other.hash = "other";
  finish(shardOf("b"), other);
  try {
    batchResults(batch, dir);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_EQ(error.code(), ExitCode::kBadInput);
    EXPECT_NE(std::string(error.what()).find("b/done.json holds the run of another"),
              std::string::npos);
  }
}

TEST_F(Results, OfAnotherTruthHaveNoFiguresAndSayWhy) {
  writeGroundTruth(folder / "b.truth.csv", {testing_evaluation::makeTruth(900, 1, 10, 0)});
  writeFile(folder / "a.truth.csv", "frame,t\n");
  const BatchResults results = batchResults(batch, dir);
  for (const std::size_t i : {0U, 1U}) {
    EXPECT_TRUE(results.shards[i].figures.empty());
    EXPECT_NE(results.shards[i].evaluation_fault.find(".truth.csv"), std::string::npos);
  }
}

TEST_F(Results, MakeTheSameBytesWhateverTheOrderOfTheManifest) {
  const BatchResults results = batchResults(batch, dir);
  const std::string csv = shardsCsv(results), page = batchPage(batch, results, dir);
  writeDatabase(results, folder / "1.sqlite");
  std::reverse(batch.shards.begin(), batch.shards.end());
  const BatchResults again = batchResults(batch, dir);
  EXPECT_EQ(shardsCsv(again), csv);
  EXPECT_EQ(batchPage(batch, again, dir), page);
  writeDatabase(again, folder / "2.sqlite");
  EXPECT_EQ(contentOf(folder / "1.sqlite"), contentOf(folder / "2.sqlite"));
}

TEST_F(Results, StandInADatabase) {
  const std::string file = folder / "batch.sqlite";
  writeDatabase(batchResults(batch, dir), file);
  EXPECT_EQ(query(file, "SELECT count(*) FROM shards"), "4");
  EXPECT_EQ(query(file, "SELECT reason FROM shards WHERE state = 'failed' AND code = 65"),
            "torn, \"cut\" </script>");
  EXPECT_EQ(query(file, "SELECT typeof(particles) || particles FROM shards WHERE id = 'a'"),
            "integer7");
  EXPECT_EQ(query(file, "SELECT seed FROM shards WHERE id = 'd'"), "null");
  EXPECT_EQ(query(file,
                  "SELECT mean FROM conditions WHERE name = 'closest.all.object_tracked_a' AND "
                  "sensors = 'L' AND shards = 1"),
            "0.75");
}

TEST_F(Results, StandInATable) {
  const std::string csv = shardsCsv(batchResults(batch, dir));
  EXPECT_EQ(csv.rfind("id,log,config,sensors,particles,seed,simulated,state,", 0), 0U);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
  EXPECT_NE(csv.find(",failed,65,\"torn, \"\"cut\"\" </script>\","), std::string::npos) << csv;
  EXPECT_EQ(timingCsv(batchResults(batch, dir), dir),
            "id,wall_seconds,cpu_seconds,real_time_factor,peak_memory_bytes\n"
            "a,2.500000,2,,\nb,2.500000,2,,\n");
}

TEST_F(Results, StandOnAPageThatNoReasonBreaks) {
  const std::string page = batchPage(batch, batchResults(batch, dir), dir);
  EXPECT_EQ(page.find("\"cut\" </script>"), std::string::npos);
  EXPECT_NE(page.find("\"link\":\"a/\""), std::string::npos);
  EXPECT_NE(page.find("<b>2</b><span>done</span>"), std::string::npos);
  EXPECT_NE(page.find("<b>1</b><span>missing</span>"), std::string::npos);
  for (const char* outside : {"http://", "https://", " src="})
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
}

TEST_F(Results, AFullDiskIsAnErrorOfTheOutput) {
  EXPECT_THROW(writeDatabase(batchResults(batch, dir), "/dev/full"), OutputError);
}

}  // namespace
}  // namespace perception::test
