#include "studies/StudyApp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "libperception/app/track/TrackApp.h"
#include "libperception/pipeline/input/LogRecorder.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

TEST(StudyApp, LeavesAReportWithTablesAndPlots) {
  const test::TemporaryFolder folder;
  const std::string out = folder.path() + "/monte-carlo";
  StudyApp app;
  const char* argv[] = {"perception-study", "monte-carlo", "-o", out.c_str(), "--runs", "4"};
  ASSERT_EQ(runApp(app, 6, argv), 0);
  for (const char* name : {"report.md", "fixed_noise.csv", "by_count.csv", "traces.png"})
    EXPECT_TRUE(std::filesystem::exists(out + "/" + name)) << name;
  std::ifstream file(out + "/report.md");
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_NE(text.str().find("Data: simulated"), std::string::npos);
}

// A few seconds of the demo's log.
RecordedLog demoLog(double seconds, const std::vector<std::string>& settings = {}) {
  Config config = Config::fromFile(PERCEPTION_SOURCE_DIR "/ini/demo.ini");
  for (const std::string& setting : settings) config.set(setting);
  return recordLog(PERCEPTION_SOURCE_DIR "/rawlogs/demo.rawlog", config, seconds);
}

TEST(RecordedLog, ReplaysWhatPerceptionTrackMakesOfTheLog) {
  TrackApp track;
  track.config_file = PERCEPTION_SOURCE_DIR "/ini/demo.ini";
  track.inputs = {PERCEPTION_SOURCE_DIR "/rawlogs/demo.rawlog"};
  const test::TemporaryFolder folder;
  track.output = folder.path() + "/run";
  track.settings = {"run.association=sampled", "particle_filter.sampleSize=6"};
  track.keep_scenes = true;
  testing::internal::CaptureStdout();
  track.run();
  testing::internal::GetCapturedStdout();

  // Recorded with the same filter: its tracks tell the front ends where vehicles have left wakes.
  const TrackedRun run = replay(demoLog(0, track.settings), {Proposal::kSampled, 6, 1, false});
  ASSERT_EQ(run.scenes.size(), track.out_scenes.size());
  std::size_t objects = 0;
  for (std::size_t k = 0; k < run.scenes.size(); ++k) {
    const Scene &a = run.scenes[k], &b = track.out_scenes[k];
    ASSERT_EQ(a.objects.size(), b.objects.size()) << k;
    for (std::size_t i = 0; i < a.objects.size(); ++i, ++objects) {
      EXPECT_EQ(a.objects[i].id, b.objects[i].id);
      EXPECT_EQ(a.objects[i].position, b.objects[i].position);
    }
  }
  EXPECT_GT(objects, 100u);
}

TEST(RecordedLog, EndsAfterTheSecondsAskedFor) {
  const RecordedLog log = demoLog(2);
  EXPECT_TRUE(log.simulated);
  const TrackedRun run = replay(log, {});
  EXPECT_NEAR(run.scenes.back().stamp - run.first_stamp, 2, 0.25);
}

const StudyTable& tableOf(const StudyReport& report, const std::string& name) {
  const auto found = std::find_if(report.tables.begin(), report.tables.end(),
                                  [&](const StudyTable& t) { return t.name == name; });
  if (found == report.tables.end()) throw std::runtime_error("no table " + name);
  return *found;
}

TEST(StudyApp, ResolutionTracksEverySensorSetOfThePaper) {
  const test::TemporaryFolder folder;
  const std::string ini = std::string(PERCEPTION_SOURCE_DIR) + "/ini/";
  const std::string out = folder.path() + "/resolution", site = ini + "skynet.ini",
                    scenario = ini + "scenarios/C.ini";
  StudyApp app;
  const char* argv[] = {
      "perception-study", "resolution", "-c", site.c_str(), "--scenario", scenario.c_str(),
      "--seconds",        "2",          "-o", out.c_str(),  "--set",      "run.without=IBEO"};
  ASSERT_EQ(runApp(app, 12, argv), 0);
  for (const char* name : {"report.md", "recall_precision.csv", "recall.png", "tracking_rate.png"})
    EXPECT_TRUE(std::filesystem::exists(out + "/" + name)) << name;
  std::vector<std::string> sets;
  for (const auto& row : tableOf(app.out_report, "tracking_rate").rows) sets.push_back(row[0]);
  EXPECT_EQ(sets,
            (std::vector<std::string>{"C-1k+R", "C-2k+R", "C-4k+R", "C-8k+R", "L+R", "C-8k+L+R"}));
  const auto& seen = tableOf(app.out_report, "detection_rate").rows;
  EXPECT_GT(std::stod(seen[3][1]), std::stod(seen[0][1]));  // 8k sees more than 1k
}

TEST(StudyApp, UnknownStudiesAreAUsageError) {
  StudyApp app;
  const char* argv[] = {"perception-study", "tea-leaves", "-o", "nowhere"};
  EXPECT_EQ(runApp(app, 4, argv), static_cast<int>(ExitCode::kUsage));
}

}  // namespace
}  // namespace perception
