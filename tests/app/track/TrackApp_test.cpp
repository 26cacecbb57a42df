#include "libperception/app/track/TrackApp.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <sys/stat.h>
#include <zlib.h>

#include <cmath>

#include "libperception/sensors/frames/ToObservation.h"
#include "tests/app/LogFaults.h"

namespace perception::test {
namespace {

/// The demo's first seconds without what `drop` says.
std::vector<Observation> without(
    const std::function<bool(const mrpt::obs::CObservation&, double)>& drop) {
  const auto log = demoStart(6);
  std::vector<Observation> out;
  for (const auto& o : log) {
    if (!drop(*o, timeIn(log, o))) out.push_back(o);
  }
  return out;
}

TEST(TrackApp, ScenesGoOnWhenTheLidarDies) {
  Tracking t;
  t.track(without([](const auto& o, double at) { return o.sensorLabel == "LIDAR_TOP" && at > 2; }));
  ASSERT_EQ(t.ended.code, 3) << t.ended.err;
  EXPECT_EQ(t.events("sensor_lost"), 1U);
  EXPECT_EQ(t.events("output_sensor"), 1U);
  const auto table = CsvTable::fromFile(t.dir + "/scenes.csv");
  EXPECT_GT(table.real(table.rows() - 1, table.column("t")), 5.7);
}

TEST(TrackApp, ScenesComeWithoutAnyLidarFrame) {
  Tracking t;
  t.track(without([](const auto& o, double) { return o.sensorLabel == "LIDAR_TOP"; }));
  ASSERT_EQ(t.ended.code, 3) << t.ended.err;
  EXPECT_NE(
      t.ended.err.find("LIDAR_TOP: in use by the configuration, but nothing of it in the log"),
      std::string::npos)
      << "warnings are said, not only counted: " << t.ended.err;
  EXPECT_EQ(t.events("sensor_missing"), 1U);
  EXPECT_GT(t.scenes(), 40U);
}

TEST(TrackApp, AbsurdPosesAreRejectedAndReported) {
  auto log = demoStart(4);
  int poses = 0;
  for (auto& o : log) {
    auto* pose = dynamic_cast<mrpt::obs::CObservationRobotPose*>(o.get());
    if (pose && ++poses % 20 == 7) pose->pose.mean.x(poses > 20 ? 1e300 : 4000);
  }
  ASSERT_GT(poses, 30);
  Tracking t;
  ASSERT_EQ(t.track(log).code, 3) << t.ended.err;
  EXPECT_GE(t.events("ego_jump"), 2U);
  const auto table = CsvTable::fromFile(t.dir + "/tracks.csv");
  for (std::size_t i = 0; i < table.rows(); ++i)
    EXPECT_LT(std::abs(table.real(i, table.column("x"))), 1000);
}

TEST(TrackApp, WhereThePosesMoveToAnotherPlaceTracksStartAnew) {
  auto log = demoStart(5);
  for (auto& o : log) {
    auto* pose = dynamic_cast<mrpt::obs::CObservationRobotPose*>(o.get());
    if (pose && timeIn(log, o) > 2) pose->pose.mean.x_incr(3000);
  }
  Tracking t;
  ASSERT_EQ(t.track(log).code, 3) << t.ended.err;
  EXPECT_EQ(t.events("ego_jump"), 2U) << "rejected, then believed";
  const auto table = CsvTable::fromFile(t.dir + "/tracks.csv");
  std::map<std::uint64_t, std::set<bool>> there;
  for (std::size_t i = 0; i < table.rows(); ++i)
    there[table.natural(i, table.column("id"))].insert(table.real(i, table.column("x")) > 1500);
  for (const auto& [id, places] : there) EXPECT_EQ(places.size(), 1U) << id;
}

TEST(TrackApp, AWrongLabelIsAnErrorThatNamesTheLabelsOfBothSides) {
  auto log = demoStart(2);
  for (auto& o : log) {
    if (o->sensorLabel == "LIDAR_TOP" || o->sensorLabel == "CAMERA") o->sensorLabel += "_2";
  }
  Tracking t;
  ASSERT_EQ(t.track(log).code, 65);
  for (const char* part :
       {"LIDAR_TOP_2 (perception::CObservationLidarScan, 21)", "CAMERA_2 (", "EGO_POSE (",
        "The configuration wants: LIDAR_TOP (lidar), CAMERA (boxes)", "whole,"})
    EXPECT_NE(t.ended.err.find(part), std::string::npos) << part << "\n" << t.ended.err;
  EXPECT_FALSE(std::filesystem::exists(t.dir));
}

TEST(TrackApp, ALogDamagedBeforeItsFirstFrameIsAnErrorThatSaysSo) {
  Tracking t;
  writeLog(demoStart(2), t.folder / "whole.rawlog");
  std::ofstream(t.folder / "cut.rawlog", std::ios::binary)
      << contentOf(t.folder / "whole.rawlog").substr(0, 700);
  ASSERT_EQ(t.track(t.folder / "cut.rawlog").code, 65);
  EXPECT_NE(t.ended.err.find("the file ends inside its gzip container"), std::string::npos)
      << t.ended.err;
}

TEST(TrackApp, InfoSaysWhatALogHolds) {
  Tracking t;
  TrackApp app;
  testing::internal::CaptureStdout();
  const char* arguments[] = {"perception-track", "--info", "-i", kDemoLog.c_str()};
  ASSERT_EQ(runApp(app, 4, arguments), 0);
  std::fflush(stdout);
  const std::string text = testing::internal::GetCapturedStdout();
  EXPECT_NE(text.find("LIDAR_TOP"), std::string::npos) << text;
  EXPECT_NE(text.find("10.0"), std::string::npos) << "[Hz]\n" << text;
}

TEST(TrackApp, AFinishedFolderIsLeftAsItIs) {
  Tracking t;
  ASSERT_EQ(t.track(demoStart(2)).code, 0) << t.ended.err;
  EXPECT_EQ(t.done().at("hash").get<std::string>().size(), 64U);
  const std::string timing = contentOf(t.dir + "/timing.json");
  const auto at = std::filesystem::last_write_time(t.dir + "/tracks.csv");
  ASSERT_EQ(t.track(t.folder / "log.rawlog", {"--threads", "1"}).code, 0) << t.ended.err;
  EXPECT_EQ(contentOf(t.dir + "/timing.json"), timing);
  EXPECT_EQ(std::filesystem::last_write_time(t.dir + "/tracks.csv"), at);
}

TEST(TrackApp, ALidarThatMeasuresNothingIsSaid) {
  auto log = demoStart(2);
  for (auto& o : log) {
    if (o->sensorLabel == "LIDAR_TOP") o->setSensorPose(mrpt::poses::CPose3D(0, 0, 60, 0, 0, 0));
  }
  Tracking t;
  ASSERT_EQ(t.track(log, {"--sensors", "L"}).code, 3) << t.ended.err;
  EXPECT_NE(t.ended.err.find("scans and no measurement came of them"), std::string::npos)
      << t.ended.err;
}

TEST(TrackApp, ARerunOfALogThatEndedWithWarningsSaysThemAgain) {
  Tracking t;
  writeLog(demoStart(1), t.folder / "whole.rawlog");
  const std::string bytes = contentOf(t.folder / "whole.rawlog"), log = t.folder / "cut.rawlog";
  std::ofstream(log, std::ios::binary) << bytes.substr(0, bytes.size() * 9 / 10);
  ASSERT_EQ(t.track(log).code, 3) << t.ended.err;
  const std::string timing = contentOf(t.dir + "/timing.json");
  ASSERT_EQ(t.track(log).code, 3) << t.ended.err;
  EXPECT_NE(t.ended.err.find("already done, with a warning: " + log + ": the file ends"),
            std::string::npos)
      << t.ended.err;
  EXPECT_EQ(contentOf(t.dir + "/timing.json"), timing);
}

TEST(TrackApp, AFolderOfAnotherRunIsRefusedUnlessOverwritten) {
  const std::vector<std::function<Ended(Tracking&, std::vector<std::string>)>> others = {
      [](Tracking& t, std::vector<std::string> o) { return t.track(demoStart(2.5), o); },
      [](Tracking& t, std::vector<std::string> o) {
        o.insert(o.end(), {"--seed", "7"});
        return t.track(t.folder / "log.rawlog", o);
      }};
  for (const auto& other : others) {
    Tracking t;
    ASSERT_EQ(t.track(demoStart(2)).code, 0) << t.ended.err;
    const std::string before = contentOf(t.dir + "/done.json");
    std::filesystem::create_directories(t.dir + "/evaluation");
    for (const char* name : {"evaluation/report.json", "scene.mp4", "index.html", "notes.txt"})
      std::ofstream(t.dir + "/" + name) << "old";
    EXPECT_EQ(other(t, {}).code, 78);
    EXPECT_NE(t.ended.err.find("--overwrite"), std::string::npos);
    EXPECT_EQ(contentOf(t.dir + "/done.json"), before);
    EXPECT_TRUE(std::filesystem::exists(t.dir + "/scene.mp4"));
    ASSERT_EQ(other(t, {"--overwrite"}).code, 0) << t.ended.err;
    EXPECT_NE(contentOf(t.dir + "/done.json"), before);
    for (const char* name : {"evaluation", "scene.mp4", "index.html"})
      EXPECT_FALSE(std::filesystem::exists(t.dir + "/" + name)) << name;
    EXPECT_TRUE(std::filesystem::exists(t.dir + "/notes.txt")) << "of the user";
  }
}

TEST(TrackApp, OverwriteTracksAgainAndAnExportNeverReplacesAnotherRun) {
  Tracking t;
  ASSERT_EQ(t.track(demoStart(2)).code, 0) << t.ended.err;
  std::ofstream(t.dir + "/tracks.csv") << "spoiled";
  ASSERT_EQ(t.track(demoStart(2)).code, 0);
  EXPECT_EQ(contentOf(t.dir + "/tracks.csv"), "spoiled") << "left alone";
  ASSERT_EQ(t.track(demoStart(2), {"--overwrite"}).code, 0);
  EXPECT_NE(contentOf(t.dir + "/tracks.csv"), "spoiled");
  const std::string before = contentOf(t.dir + "/done.json");
  EXPECT_EQ(t.track(demoStart(2), {"--seed", "7", "--export", "kitti:" + t.dir + "/k.txt"}).code,
            78);
  EXPECT_EQ(contentOf(t.dir + "/done.json"), before);
}

/// The bytes inside a gzip file.
std::string inflated(const std::string& path) {
  std::string out;
  const gzFile file = gzopen(path.c_str(), "rb");
  char part[65536];
  for (int got = 0; (got = gzread(file, part, sizeof part)) > 0;)
    out.append(part, static_cast<std::size_t>(got));
  gzclose(file);
  return out;
}

TEST(TrackApp, ALogThatMayBeCutBetweenTwoEntriesIsNotVerifiable) {
  Tracking t;
  ASSERT_EQ(t.track(demoStart(2)).code, 0) << t.ended.err;
  EXPECT_EQ(t.done().at("input").at("whole"), "verified");
  Tracking plain;
  std::ofstream(plain.folder / "plain.rawlog", std::ios::binary)
      << inflated(t.folder / "log.rawlog");
  ASSERT_EQ(plain.track(plain.folder / "plain.rawlog").code, 0) << plain.ended.err;
  EXPECT_EQ(plain.done().at("input").at("whole"), "not verifiable");
  EXPECT_EQ(contentOf(plain.dir + "/tracks.csv"), contentOf(t.dir + "/tracks.csv"));
  Tracking cut;
  std::ofstream(cut.folder / "cut.rawlog", std::ios::binary)
      << contentOf(t.folder / "log.rawlog").substr(0, 900000);
  ASSERT_EQ(cut.track(cut.folder / "cut.rawlog").code, 3) << cut.ended.err;
  EXPECT_EQ(cut.done().at("input").at("whole"), "no");
}

TEST(TrackApp, ASensorSetWithoutASensorIsRefused) {
  Tracking t;
  EXPECT_EQ(t.track(demoStart(0.2), {"--sensors", "R"}).code, 78);
  EXPECT_NE(t.ended.err.find("no [sensor.LABEL] section has a modality of 'R'"), std::string::npos)
      << t.ended.err;
  EXPECT_FALSE(std::filesystem::exists(t.dir));
}

TEST(TrackApp, APipeAsConfigurationOrIncludeIsRefused) {
  Tracking t;
  ASSERT_EQ(::mkfifo((t.folder / "pipe.ini").c_str(), 0600), 0);
  std::ofstream(t.folder / "with.ini") << "include = pipe.ini\n";
  for (const char* ini : {"pipe.ini", "with.ini"}) {
    TrackApp app;
    const Ended ended = runProgram(app, {"-c", t.folder / ini, "-i", kDemoLog, "-o", t.dir});
    EXPECT_EQ(ended.code, 78);
    EXPECT_NE(ended.err.find("is a pipe"), std::string::npos) << ended.err;
  }
}

}  // namespace
}  // namespace perception::test
