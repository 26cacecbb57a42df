#include "libperception/app/StudyApp.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "libperception/app/LogRecorder.h"
#include "libperception/app/TrackApp.h"
#include "libperception/study/LogParticlesStudy.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

TEST(StudyApp, LeavesAReportWithTablesAndPlots) {
  const test::TemporaryFolder folder;
  const std::string out = folder.path() + "/heading";
  StudyApp app;
  const char* argv[] = {"perception-study", "heading", "-o", out.c_str(), "--runs", "4"};
  ASSERT_EQ(runApp(app, 6, argv), 0);
  for (const char* name : {"report.md", "camera.csv", "camera_and_radar.csv", "heading_camera.png"})
    EXPECT_TRUE(std::filesystem::exists(out + "/" + name)) << name;
  std::ifstream file(out + "/report.md");
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_NE(text.str().find("Data: simulated"), std::string::npos);
}

// A few seconds of the demo's log.
RecordedLog demoLog(double seconds) {
  Config config = Config::fromFile(PERCEPTION_SOURCE_DIR "/ini/demo.ini");
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

  const TrackedRun run = replay(demoLog(0), {Proposal::kSampled, 6, 1, false});
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

TEST(LogParticlesStudy, DoesNotDependOnTheThreads) {
  const RecordedLog log = demoLog(3);
  LogParticlesParams params;
  params.counts = {1, 8};
  const StudyReport many = logParticlesStudy(params, log, nullptr, nullptr);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const StudyReport single = logParticlesStudy(params, log, nullptr, nullptr);
  EXPECT_EQ(markdownOf(many), markdownOf(single));
}

TEST(StudyApp, CountsTheParticlesThatALogNeeds) {
  const test::TemporaryFolder folder;
  const std::string out = folder.path() + "/particles";
  StudyApp app;
  const char* argv[] = {"perception-study",
                        "particles",
                        "-o",
                        out.c_str(),
                        "--log",
                        PERCEPTION_SOURCE_DIR "/rawlogs/demo.rawlog",
                        "-c",
                        PERCEPTION_SOURCE_DIR "/ini/demo.ini",
                        "--truth",
                        PERCEPTION_SOURCE_DIR "/rawlogs/demo.truth.csv",
                        "--seconds",
                        "3"};
  testing::internal::CaptureStdout();
  const int code = runApp(app, 12, argv);
  testing::internal::GetCapturedStdout();
  ASSERT_EQ(code, 0);
  for (const char* name : {"report.md", "counts.csv", "tracking.csv", "cdf.csv", "errors.png"})
    EXPECT_TRUE(std::filesystem::exists(out + "/" + name)) << name;
  ASSERT_EQ(app.out_report.tables.size(), 3u);
  // The reference stands first and has no error against itself.
  EXPECT_EQ(app.out_report.tables[0].rows[0][0], "joint, 50");
  EXPECT_EQ(app.out_report.tables[0].rows[0][2], "0.00");
  EXPECT_EQ(app.out_report.tables[0].rows[3][1], "3.80 / 1.80");
}

TEST(StudyApp, EgoReportsErrorsThroughAGapOfSatellites) {
  const test::TemporaryFolder folder;
  const std::string out = folder.path() + "/ego";
  const std::string scenario = std::string(PERCEPTION_SOURCE_DIR) + "/ini/scenarios/gnss_gap.ini";
  StudyApp app;
  const char* argv[] = {"perception-study", "ego",    "-c", scenario.c_str(), "-o",
                        out.c_str(),        "--runs", "3"};
  ASSERT_EQ(runApp(app, 8, argv), 0);
  for (const char* name : {"report.md", "phases.csv", "ego.png"})
    EXPECT_TRUE(std::filesystem::exists(out + "/" + name)) << name;
  ASSERT_EQ(app.out_report.tables.size(), 1U);
  const auto& rows = app.out_report.tables[0].rows;
  ASSERT_EQ(rows.size(), 3U);  // before, in and after the gap
  EXPECT_EQ(rows[1][2], "gap of 10 s");
  EXPECT_LT(std::stod(rows[1][4]), 2);  // [m] the worst of all
  EXPECT_LT(std::stod(rows[1][7]), 2);  // [deg]
}

TEST(StudyApp, UnknownStudiesAreAUsageError) {
  StudyApp app;
  const char* argv[] = {"perception-study", "tea-leaves", "-o", "nowhere"};
  EXPECT_EQ(runApp(app, 4, argv), static_cast<int>(ExitCode::kUsage));
}

}  // namespace
}  // namespace perception
