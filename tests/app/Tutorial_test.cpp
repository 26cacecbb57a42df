#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <variant>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/sensors/ego/EgoPose.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "tests/app/DemoLog.h"
#include "tests/app/DocumentCommands.h"
#include "tests/support/CommandOutput.h"
#include "tests/support/TemporaryFolder.h"

// The commands of docs/tutorial.md are run as they stand there, in their order, in a folder that
// holds what the tutorial's reader has: a folder of scans and their poses, here of the demo log.
namespace perception {
namespace {

namespace fs = std::filesystem;
using test::CommandOutput;
using test::commandsIn;
using test::outputOf;

const std::string kTutorial = PERCEPTION_SOURCE_DIR "/docs/tutorial.md";

void writeCloud(const LidarCloud& cloud, const std::string& path) {
  std::ofstream out(path, std::ios::binary);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float row[4] = {cloud.x[i], cloud.y[i], cloud.z[i],
                          cloud.intensity.empty() ? 0.f : cloud.intensity[i]};
    out.write(reinterpret_cast<const char*>(row), sizeof row);
  }
}

void writePose(const Pose3& T, std::ostream& out) {
  for (Eigen::Index row = 0; row < 3; ++row)
    for (Eigen::Index column = 0; column < 4; ++column)
      out << T.matrix()(row, column) << (row == 2 && column == 3 ? "\n" : " ");
}

/// Writes FOLDER/clouds and FOLDER/poses.txt (of the lidar in the world) from the demo log, whose
/// lidar is mounted as the tutorial's. Returns the number of scans.
int writeScans(const std::string& folder) {
  fs::create_directory(folder + "/clouds");
  std::ofstream poses(folder + "/poses.txt");
  poses.precision(17);
  RawlogReader log(test::kDemoLog);
  int scans = 0;
  Pose3 T_world_ego = Pose3::Identity();
  while (const auto observation = log.next()) {
    if (const auto ego = loggedPose(*observation)) T_world_ego = ego->T_world_ego;
    const auto frame = frameFromObservation(*observation);
    if (!frame || !std::holds_alternative<LidarCloud>(frame->data)) continue;
    const std::string number = std::to_string(1000 + scans++);
    writeCloud(std::get<LidarCloud>(frame->data), folder + "/clouds/" + number + ".bin");
    writePose(T_world_ego * frame->T_ego_sensor, poses);
  }
  return scans;
}

/// The same drive as a ROS 2 recording.
void writeRecording(const std::string& folder) {
  const CommandOutput output =
      outputOf({PERCEPTION_BINARY_DIR "/bin/perception-export", "-i", test::kDemoLog, "--format",
                "ros2", "-o", folder + "/drive.mcap"});
  ASSERT_EQ(output.code, 0) << output.text;
}

TEST(Tutorial, ItsCommandsRunInTheirOrder) {
  const test::TemporaryFolder folder;
  ASSERT_GT(writeScans(folder.path()), 100);
  writeRecording(folder.path());
  std::vector<std::string> commands = commandsIn(kTutorial, "perception-");
  ASSERT_GT(commands.size(), 10u);
  for (std::string command : commands) {
    if (command == "perception-demo") continue;  // a whole run of its own: ./setup.sh demo
    if (const auto at = command.find("drive.bag"); at != std::string::npos)
      command.replace(at, 9, "drive.mcap");
    const CommandOutput output = outputOf(test::wordsOf(command), folder.path());
    ASSERT_EQ(output.code, 0) << command << "\n" << output.text;
  }
  for (const char* file : {"doctor/site.ini", "doctor/doctor.png", "run/tracks.csv",
                           "run/index.html", "run2/tracks.csv", "review.html"})
    EXPECT_TRUE(fs::exists(folder / file)) << file;
}

}  // namespace
}  // namespace perception
