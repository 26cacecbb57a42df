#include "libperception/app/ExportApp.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "libperception/app/ImportApp.h"
#include "libperception/app/track/TrackApp.h"
#include "libperception/scene/files/RunMark.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/scene/files/TrackedRun.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "tests/support/CommandOutput.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

const std::string kLog = PERCEPTION_SOURCE_DIR "/rawlogs/demo.rawlog";

// Eleven scenes, a car in the first five.
class ExportAppTest : public testing::Test {
 protected:
  void SetUp() override {
    dir_ = testing::TempDir() + "export_app_" +
           testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(dir_);
    fs::create_directories(dir_);
  }
  void TearDown() override { fs::remove_all(dir_); }

  void writeRun(Stamp first) {
    ClassTable classes;
    classes.classes.emplace_back();
    classes.classes.back().name = "car";
    TrackedRunWriter writer(dir_, classes, first);
    for (int k = 0; k < 11; ++k) {
      Scene scene;
      scene.stamp = first + 0.1 * k;
      SceneObject car;
      car.id = 7;
      car.class_probability = {1.0};
      car.speed = 2.5;
      car.length = car.width = car.height = 1;
      if (k < 5) scene.objects = {car};
      writer.write(scene);
    }
    writer.close();
  }

  int run() {
    const std::string out = dir_ + "/a.mcap";
    const char* argv[] = {"perception-export", "-i", kLog.c_str(), "-r",
                          dir_.c_str(),        "-o", out.c_str()};
    return runApp(app_, 7, argv);
  }

  std::string dir_;
  ExportApp app_;
};

TEST_F(ExportAppTest, ALogOfOtherTimesIsRefused) {
  writeRun(Stamp::fromSeconds(1));
  EXPECT_EQ(run(), static_cast<int>(ExitCode::kBadInput));
  EXPECT_FALSE(fs::exists(dir_ + "/a.mcap"));
}

TEST_F(ExportAppTest, TheFileSaysOfWhichRunItIs) {
  writeRun(Stamp::fromSeconds(1577836800));
  RunRecord record;
  record.hash = std::string(64, 'a');
  writeRunRecord(dir_ + "/done.json", record);
  for (const char* format : {"foxglove", "ros2"}) {
    app_.format = format;
    ASSERT_EQ(run(), 0);
    EXPECT_EQ(markedRunsOf(dir_ + "/a.mcap"), std::vector<std::string>{record.hash}) << format;
  }
}

TEST_F(ExportAppTest, PythonReadsTheRun) {
  if (test::outputOf({"/usr/bin/python3", "-c", "import numpy"}).code != 0)
    GTEST_SKIP() << "missing tool: python3-numpy";
  writeRun(Stamp{1'600'000'000'123'456'789});
  const auto [code, text] = test::outputOf(
      {"/usr/bin/python3", "-B", "-c",
       "import sys; from perception_run import Run; r = Run(sys.argv[1]); "
       "print(len(r.scenes), len(r.track(7)), r.tracks['stamp_ns'][0], r.tracks['speed'][0], "
       "r.probability('car')[0], r.classes)",
       dir_},
      PERCEPTION_SOURCE_DIR "/apps/perception-export");
  EXPECT_EQ(code, 0);
  EXPECT_EQ(text, "11 5 1600000000123456789 2.5 1.0 ['car']\n");
}

// What a ROS 2 recording of the log gives is what the log gives.
TEST_F(ExportAppTest, RosMessagesComeBackAsTheSameTracks) {
  const std::string mcap = dir_ + "/log.mcap", back = dir_ + "/back.rawlog";
  const auto call = [](App& app, const std::vector<const char*>& words) {
    return runApp(app, static_cast<int>(words.size()), words.data());
  };
  ASSERT_EQ(
      call(app_, {"perception-export", "-i", kLog.c_str(), "--format", "ros2", "-o", mcap.c_str()}),
      0);
  EXPECT_EQ(app_.out_frames, 111u);
  ImportApp import;
  ASSERT_EQ(call(import, {"perception-import", "bag", "--bag", mcap.c_str(), "-o", back.c_str()}),
            0);
  std::vector<std::vector<Scene>> runs;
  for (const std::string& log : {kLog, back}) {
    TrackApp track;
    track.keep_scenes = true;
    const std::string out = dir_ + "/run" + std::to_string(runs.size());
    ASSERT_EQ(call(track, {"perception-track", "-c", PERCEPTION_SOURCE_DIR "/ini/demo.ini", "-i",
                           log.c_str(), "--sensors", "L", "-o", out.c_str()}),
              0);
    runs.push_back(track.out_scenes);
  }
  ASSERT_EQ(runs[0].size(), runs[1].size());
  std::size_t objects = 0;
  for (std::size_t k = 0; k < runs[0].size(); ++k) {
    const auto &a = runs[0][k].objects, &b = runs[1][k].objects;
    ASSERT_EQ(a.size(), b.size()) << k;
    EXPECT_EQ(runs[0][k].stamp, runs[1][k].stamp);
    for (std::size_t i = 0; i < a.size(); ++i, ++objects) {
      EXPECT_EQ(a[i].id, b[i].id);
      EXPECT_EQ(a[i].class_id, b[i].class_id);
      EXPECT_LT((a[i].position - b[i].position).norm(), 1e-3) << k;
    }
  }
  EXPECT_GT(objects, 1000u);
}

/// The radar scans of a log, in order.
std::vector<SensorFrame> radarFrames(const std::string& log) {
  std::vector<SensorFrame> frames;
  RawlogReader reader(log);
  while (const auto observation = reader.next()) {
    auto frame = frameFromObservation(*observation);
    if (frame && std::holds_alternative<RadarReturns>(frame->data))
      frames.push_back(std::move(*frame));
  }
  return frames;
}

TEST_F(ExportAppTest, RadarScansComeBackFromRosMessages) {
  const std::string log = PERCEPTION_SOURCE_DIR "/rawlogs/radar.rawlog";
  const std::string mcap = dir_ + "/radar.mcap", back = dir_ + "/back.rawlog";
  const char* argv[] = {"perception-export", "-i", log.c_str(), "--format", "ros2", "-o",
                        mcap.c_str()};
  ASSERT_EQ(runApp(app_, 7, argv), 0);
  EXPECT_EQ(app_.out_frames, 8 * 230U);
  ImportApp import;
  const char* words[] = {"perception-import", "bag", "--bag", mcap.c_str(), "-o", back.c_str()};
  ASSERT_EQ(runApp(import, 6, words), 0);
  const auto before = radarFrames(log), after = radarFrames(back);
  ASSERT_EQ(before.size(), after.size());
  std::size_t returns = 0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    ASSERT_EQ(before[k].sensor, after[k].sensor);
    EXPECT_EQ(before[k].stamp, after[k].stamp);
    EXPECT_TRUE(before[k].T_ego_sensor.isApprox(after[k].T_ego_sensor, 1e-9));
    const auto& a = std::get<RadarReturns>(before[k].data).returns;
    const auto& b = std::get<RadarReturns>(after[k].data).returns;
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i, ++returns) {
      EXPECT_NEAR(a[i].range, b[i].range, 1e-4);
      EXPECT_NEAR(a[i].bearing, b[i].bearing, 1e-6);
      EXPECT_NEAR(a[i].range_rate, b[i].range_rate, 1e-5);
    }
  }
  EXPECT_GT(returns, 500U);
}

TEST_F(ExportAppTest, ALogOfRadarsAloneIsWrittenForFoxglove) {
  const std::string log = PERCEPTION_SOURCE_DIR "/rawlogs/radar.rawlog", out = dir_ + "/r.mcap";
  RawlogReader reader(log);
  writeRun(*toStamp(reader.next()->timestamp));
  const char* argv[] = {"perception-export", "-i", log.c_str(), "-r",
                        dir_.c_str(),        "-o", out.c_str()};
  ASSERT_EQ(runApp(app_, 7, argv), 0);
  EXPECT_GT(app_.out_frames, 50U);  // eight radars for a second
  std::ifstream file(out, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(bytes.find("range_rate"), std::string::npos);
}

TEST_F(ExportAppTest, RosMessagesHoldTheTracksOfARun) {
  writeRun(Stamp::fromSeconds(1577836800));
  const std::string out = dir_ + "/b.mcap";
  const char* argv[] = {"perception-export", "-i",   kLog.c_str(), "-r",       dir_.c_str(),
                        "--format",          "ros2", "-o",         out.c_str()};
  ASSERT_EQ(runApp(app_, 9, argv), 0);
  std::ifstream file(out, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(bytes.find("vision_msgs/msg/Detection3DArray"), std::string::npos);
  EXPECT_NE(bytes.find("MSG: geometry_msgs/PoseWithCovariance"), std::string::npos);
}

}  // namespace
}  // namespace perception
