// Another make of DDS plays the vehicle in a process of its own, and reads what we send.
#include <gtest/gtest.h>
#include <mrpt/serialization/CSerializable.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "libperception/core/system/ChildProcess.h"
#include "libperception/interop/exports/ExportFile.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "tests/dds/SensorTopics.h"
#include "tests/support/CommandOutput.h"

namespace perception {
namespace {

#ifdef PERCEPTION_FAST_VEHICLE

const std::string kBin = PERCEPTION_BINARY_DIR "/bin/";
const std::string kIni = PERCEPTION_SOURCE_DIR "/ini/kitti.ini";

void waitFor(double seconds) { usleep(static_cast<useconds_t>(seconds * 1e6)); }

std::string textOf(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Until the text is in the file, 20 s at most.
bool appears(const std::string& path, const std::string& text) {
  for (int i = 0; i < 400 && textOf(path).find(text) == std::string::npos; ++i) waitFor(0.05);
  return textOf(path).find(text) != std::string::npos;
}

/// Scans of three cars that drive beside each other, and of the ground, at 10 Hz.
void writeRecording(const std::string& path, int scans, std::int64_t second = 1'500'000'000) {
  const auto file = makeRosFile(path, {}, "");
  for (int k = 0; k < scans; ++k) {
    const Stamp stamp{second * 1'000'000'000 + k * 100'000'000LL};
    file->writePose(stamp, makePose(0.8 * k, 0, 0, 0));
    LidarCloud cloud;
    const auto add = [&](double x, double y, double z) {
      cloud.x.push_back(static_cast<float>(x));
      cloud.y.push_back(static_cast<float>(y));
      cloud.z.push_back(static_cast<float>(z - 1.7));
      cloud.intensity.push_back(0.5F);
    };
    for (int car = 0; car < 3; ++car) {
      const double x = 12 + 8 * car + 0.2 * k, y = -3.5 + 3.5 * car;
      for (double z = 0.3; z < 1.5; z += 0.15) {
        for (double s = -0.9; s <= 0.9; s += 0.1) add(x - 2.1, y + s, z);
        for (double s = -2.1; s <= 2.1; s += 0.1) add(x + s, y - 0.9 * (y > 0 ? 1 : -1), z);
      }
    }
    for (double x = 4; x < 40; x += 0.7)
      for (double y = -8; y < 8; y += 0.7) add(x, y, 0);
    SensorFrame frame;
    frame.sensor = "LIDAR_TOP";
    frame.stamp = stamp;
    frame.T_ego_sensor = makePose(0, 0, 1.7, 0);
    frame.data = std::move(cloud);
    file->writeFrame(frame);
  }
  file->close();
}

class FastVehicle : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(path("graph.ini")) << "[ros]\nnetwork = lo:" << domain_ << "\n";
  }
  std::string path(const std::string& name) const { return folder_ / name; }
  ChildCommand vehicle(std::vector<std::string> words, const std::string& output) const {
    words.insert(words.begin(), PERCEPTION_FAST_VEHICLE);
    ChildCommand command;
    command.words = std::move(words);
    command.output = path(output);
    return command;
  }
  ChildCommand play(const std::string& recording, std::vector<std::string> options) const {
    options.insert(options.begin(), {"play", path(recording), domain()});
    return vehicle(options, "vehicle.txt");
  }
  ChildCommand track(const std::string& to, const std::vector<std::string>& more = {}) const {
    ChildCommand command;
    command.words = {kBin + "perception-track",   "-c", kIni,    "-i",
                     "ros2:" + path("graph.ini"), "-o", path(to)};
    command.words.insert(command.words.end(), more.begin(), more.end());
    command.output = path(to + ".txt");
    return command;
  }
  std::string domain() const { return std::to_string(domain_); }

  const test::TemporaryFolder folder_;
  const int domain_ = 100 + getpid() % 100;
};

TEST_F(FastVehicle, ItsDriveIsTrackedLiveAsFromItsRecording) {
  writeRecording(path("drive.mcap"), 25);
  {
    ChildProcess tracker(track("live", {"--publish", "lo:" + domain()}));
    ChildProcess listener(
        vehicle({"listen", domain(), "60", "/tracks", "vision_msgs/Detection3DArray",
                 "/tracks/markers", "visualization_msgs/MarkerArray"},
                "heard.txt"));
    ChildProcess player(play("drive.mcap", {"--wait", "3"}));
    player.wait();
    waitFor(1);
    tracker.stop();
    tracker.wait();
    listener.stop();
    ASSERT_TRUE(tracker.exitCode() == 0 || tracker.exitCode() == 3) << textOf(path("live.txt"));
  }
  const auto imported =
      test::outputOf({kBin + "perception-import", "bag", "--bag", path("drive.mcap"), "-c",
                      path("graph.ini"), "-o", path("drive.rawlog")});
  ASSERT_EQ(imported.code, 0) << imported.text;
  const auto tracked = test::outputOf(
      {kBin + "perception-track", "-c", kIni, "-i", path("drive.rawlog"), "-o", path("log")});
  const std::string tracks = textOf(path("log/tracks.csv"));
  EXPECT_GT(std::count(tracks.begin(), tracks.end(), '\n'), 25) << tracked.text;
  EXPECT_EQ(textOf(path("live/tracks.csv")), tracks) << textOf(path("live.txt"));
  EXPECT_EQ(textOf(path("live/scenes.csv")), textOf(path("log/scenes.csv")));
  const std::string heard = textOf(path("heard.txt"));
  // The stamp of a scene as Fast DDS got it: 1500000002 s, little endian.
  EXPECT_NE(heard.find("/tracks "), std::string::npos);
  EXPECT_NE(heard.find("022f6859"), std::string::npos) << heard.substr(0, 300);
  EXPECT_NE(heard.find("/tracks/markers "), std::string::npos);
}

TEST_F(FastVehicle, OneThatWasThereBeforeAndIsKilledAndComesBackIsReadOn) {
  writeRecording(path("drive.mcap"), 200);
  writeRecording(path("later.mcap"), 200, 1'500'000'060);
  ChildProcess first(play("drive.mcap", {"--best-effort"}));
  ASSERT_TRUE(appears(path("vehicle.txt"), "playing"));
  ChildProcess tracker(track("live"));
  ASSERT_TRUE(appears(path("live.txt"), "/LIDAR_TOP: sensor_msgs/PointCloud2, 1 writers, best"));
  waitFor(1);
  first.stop();
  first.wait();
  ChildProcess second(play("later.mcap", {}));
  EXPECT_TRUE(appears(path("live.txt"), "/LIDAR_TOP: sensor_msgs/PointCloud2, 1 writers, reliable"))
      << "once the first has been silent for 3 s";
  waitFor(1);
  tracker.stop();
  tracker.wait();
  second.stop();
  const std::string told = textOf(path("live.txt"));
  ASSERT_TRUE(tracker.exitCode() == 0 || tracker.exitCode() == 3) << told;
  const std::string scenes = textOf(path("live/scenes.csv"));
  EXPECT_GT(std::count(scenes.begin(), scenes.end(), '\n'), 20) << told;
  EXPECT_NE(scenes.find(",150000006"), std::string::npos) << "60 s later, of the second\n"
                                                          << scenes;
}

/// A log's observations as bytes, by sensor and time.
std::map<std::string, std::vector<std::string>> observationsOf(const std::string& log) {
  std::map<std::string, std::vector<std::pair<Stamp, std::string>>> found;
  RawlogReader reader(log);
  while (const auto observation = reader.next()) {
    const auto stamp = toStamp(observation->timestamp);
    if (!stamp || observation->sensorLabel.empty()) continue;
    std::vector<std::uint8_t> bytes;
    mrpt::serialization::ObjectToOctetVector(observation.get(), bytes);
    found[observation->sensorLabel].emplace_back(*stamp, std::string(bytes.begin(), bytes.end()));
  }
  std::map<std::string, std::vector<std::string>> sorted;
  for (auto& [label, all] : found) {
    std::sort(all.begin(), all.end());
    for (auto& row : all) sorted[label].push_back(std::move(row.second));
  }
  return sorted;
}

/// A signal to a program that this test has started, and to what that has started.
void tell(const std::string& program, int signal) {
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string words = textOf(entry.path() / "cmdline");
    const pid_t process = std::stoi(name);
    if (words.find(program) != std::string::npos && getpgid(process) != getpgrp())
      kill(process, signal);
  }
}

/// The number before `what` in a line that begins with `topic`; 0 without such a line.
std::size_t toldOf(const std::string& text, const std::string& topic, const std::string& what) {
  std::smatch found;
  const std::regex line(topic + ": ([0-9]+) " + what);
  return std::regex_search(text, found, line) ? std::stoul(found[1]) : 0;
}

// The reader's process stands still for longer than the system's buffer can hold what comes, but
// not so long that it takes the vehicle for gone.
TEST_F(FastVehicle, WhatIsLostOnBestEffortIsCountedAndTold) {
  constexpr int kScans = 1400;
  writeRecording(path("drive.mcap"), kScans);
  ChildCommand record;
  record.words = {kBin + "perception-grabber", "-c", "ros2:" + path("graph.ini"), "-o",
                  path("live")};
  record.output = path("grabber.txt");
  ChildProcess grabber(record);
  ChildProcess player(play("drive.mcap", {"--wait", "2", "--best-effort", "--speed", "20"}));
  ASSERT_TRUE(appears(path("vehicle.txt"), "playing"));
  waitFor(1);
  tell(path("graph.ini"), SIGSTOP);
  waitFor(2);
  tell(path("graph.ini"), SIGCONT);
  player.wait();
  waitFor(3);
  grabber.stop();
  grabber.wait();
  const std::string told = textOf(path("grabber.txt"));
  const std::size_t lost = toldOf(told, "/LIDAR_TOP", "messages lost");
  const std::size_t overrun = toldOf(told, "/LIDAR_TOP", "messages came faster");
  EXPECT_GT(lost, 0U) << told;
  EXPECT_EQ(grabber.exitCode(), 3) << told;
  const auto live = observationsOf(path("live/capture_0001.rawlog"));
  ASSERT_EQ(live.count("LIDAR_TOP"), 1U) << told;
  EXPECT_EQ(live.at("LIDAR_TOP").size() + lost + overrun, static_cast<std::size_t>(kScans)) << told;
}

class FastSensors : public FastVehicle, public testing::WithParamInterface<bool> {};

TEST_P(FastSensors, MessagesOfEachKindArriveAsTheImportOfTheirBagHasThem) {
  std::ofstream(path("graph.ini"), std::ios::app)  // boxes are read where their topic is named
      << "[topic./boxes]\nlabel = BOXES\n[topic./front/boxes]\nlabel = FRONT_BOXES\n";
  test::writeSensorTopics(path("sensors.mcap"));
  {
    ChildCommand record;
    record.words = {kBin + "perception-grabber", "-c", "ros2:" + path("graph.ini"), "-o",
                    path("live")};
    record.output = path("grabber.txt");
    ChildProcess grabber(record);
    std::vector<std::string> options = {"--wait", std::to_string(test::kSensorTopics)};
    if (!GetParam()) options.emplace_back("--best-effort");
    ChildProcess player(play("sensors.mcap", options));
    player.wait();
    waitFor(3);  // the patience of what waits for a place
    grabber.stop();
    grabber.wait();
    ASSERT_TRUE(grabber.exitCode() == 0 || grabber.exitCode() == 3) << textOf(path("grabber.txt"));
  }
  const auto imported =
      test::outputOf({kBin + "perception-import", "bag", "--bag", path("sensors.mcap"), "-c",
                      path("graph.ini"), "-o", path("sensors.rawlog")});
  ASSERT_TRUE(imported.code == 0 || imported.code == 3) << imported.text;
  registerPerceptionClasses();
  const auto live = observationsOf(path("live/capture_0001.rawlog"));
  const auto bag = observationsOf(path("sensors.rawlog"));
  EXPECT_EQ(bag.size(), test::kSensorTopics) << imported.text;
  for (const auto& [label, all] : bag) {
    EXPECT_EQ(all.size(), static_cast<std::size_t>(test::kSensorSteps)) << label;
    ASSERT_EQ(live.count(label), 1U) << label << textOf(path("grabber.txt"));
    ASSERT_EQ(live.at(label).size(), all.size()) << label << textOf(path("grabber.txt"));
    for (std::size_t i = 0; i < all.size(); ++i)
      EXPECT_TRUE(live.at(label)[i] == all[i]) << label << ", number " << i;
  }
  EXPECT_EQ(live.size(), bag.size());
}

INSTANTIATE_TEST_SUITE_P(ReliableAndBestEffort, FastSensors, testing::Bool());

#else

TEST(FastVehicle, PlaysTheVehicle) {
  GTEST_SKIP() << "Fast DDS (libfastrtps-dev) is not installed";
}

#endif

}  // namespace
}  // namespace perception
