// Sensors at work: drivers in perception-grabber, its stream into perception-track.
#include <gtest/gtest.h>

#include "tests/app/LogFaults.h"

namespace perception::test {
namespace {

/// A capture INI that plays the demo's first seconds, `lines` added.
std::string playedDemo(const TemporaryFolder& folder, const std::string& lines) {
  writeLog(demoStart(4), folder / "played.rawlog");
  std::ofstream(folder / "live.ini")
      << "[global]\n[LOG]\ndriver = CRawlogSensor\nprocess_rate = 500\n"
         "sensorLabel = LOG\nrawlog = "
      << (folder / "played.rawlog") << "\n"
      << lines;
  return "live:" + (folder / "live.ini");
}

TEST(LiveTrack, ItsResultsAreThoseOfItsRecord) {
  Tracking live, recorded;
  const std::string record = live.folder / "record";
  const Ended ended =
      live.track(playedDemo(live.folder, "speed = 4\n"),
                 {"--duration", "2.5", "--record", record, "--set", "run.reorder_window=0.2"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_GT(live.scenes(), 30U);
  ASSERT_EQ(
      recorded.track(record + "/capture_0001.rawlog", {"--set", "run.reorder_window=0.2"}).code, 0);
  for (const char* table : {"/tracks.csv", "/scenes.csv"})
    EXPECT_EQ(contentOf(live.dir + table), contentOf(recorded.dir + table)) << table;
  const auto timing = nlohmann::json::parse(contentOf(live.dir + "/timing.json"));
  EXPECT_EQ(timing.at("latency").at("scenes"), live.scenes());
  EXPECT_LE(timing.at("latency").at("p50_seconds"), timing.at("latency").at("p99_seconds"));
  EXPECT_EQ(live.done().at("input").at("end"), "clean");
  EXPECT_FALSE(nlohmann::json::parse(contentOf(recorded.dir + "/timing.json")).contains("latency"));
}

TEST(LiveTrack, WhatHoldsARunIsNotReplaced) {
  Tracking t;
  ASSERT_EQ(t.track(playedDemo(t.folder, "speed = 8\n"), {"--duration", "1.5"}).code, 0)
      << t.ended.err;
  EXPECT_EQ(t.track("live:" + (t.folder / "live.ini"), {"--duration", "1.5"}).code, 78);
  EXPECT_NE(t.ended.err.find("--overwrite"), std::string::npos);
}

TEST(LiveTrack, WithoutSensorsItSaysWhy) {
  Tracking t;
  std::ofstream(t.folder / "wrong.ini") << "[A]\ndriver = CNoSuchSensor\n";
  EXPECT_EQ(t.track("live:" + (t.folder / "wrong.ini"), {"--duration", "2"}).code, 65);
  EXPECT_NE(t.ended.err.find("perception-grabber ended with code 78"), std::string::npos)
      << t.ended.err;
  EXPECT_EQ(t.track("live:" + (t.folder / "none.ini")).code, 66);
}

TEST(LiveTrack, OptionsOfSensorsAtWorkAreRefusedForLogs) {
  Tracking t;
  EXPECT_EQ(t.track(kDemoLog, {"--duration", "2"}).code, 64);
  EXPECT_EQ(t.track(kDemoLog, {"--record", t.folder / "record"}).code, 64);
  EXPECT_EQ(t.track("live:a.ini", {"-i", kDemoLog}).code, 64);
  EXPECT_EQ(t.track(kDemoLog, {"--publish", "lo:x"}).code, 64);
}

}  // namespace
}  // namespace perception::test
