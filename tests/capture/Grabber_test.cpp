// Recording as users do it: MRPT's own rawlog-grabber with our plugin and ini/capture_stock.ini.
#include <gtest/gtest.h>
#include <mrpt/obs/CObservationComment.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>

#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "libperception/simulation/Simulator.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

TEST(Grabber, RecordsTheSensorsOfAScenario) {
  const std::string plugin =
      std::string(PERCEPTION_BINARY_DIR) + "/lib/libperception_mrpt_plugin.so";
  if (!fs::exists(plugin)) GTEST_SKIP() << "not built: " << plugin;
  if (std::system("command -v rawlog-grabber > /dev/null") != 0)
    GTEST_SKIP() << "missing tool: rawlog-grabber (package mrpt-apps)";
  const fs::path dir = fs::path(testing::TempDir()) / "grabber test";
  fs::remove_all(dir);
  fs::create_directories(dir);
  // The INI of the repository, with paths that hold wherever the test runs.
  std::ifstream shipped(PERCEPTION_SOURCE_DIR "/ini/capture_stock.ini");
  std::stringstream text;
  text << shipped.rdbuf();
  std::string ini = std::regex_replace(text.str(), std::regex("out/capture/demo"), "log");
  ini = std::regex_replace(ini, std::regex("= ini/scenarios"),
                           "= " PERCEPTION_SOURCE_DIR "/ini/scenarios");
  std::ofstream(dir / "capture.ini") << ini;
  std::string log;
  // On a machine with other work four seconds may not be enough until the first scan is written.
  for (const int seconds : {4, 20}) {
    if (!log.empty()) fs::remove(log);
    const std::string command = "cd '" + dir.string() + "' && (sleep " + std::to_string(seconds) +
                                "; echo q) | rawlog-grabber -p '" + plugin +
                                "' capture.ini > said.txt 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0);
    for (const auto& entry : fs::directory_iterator(dir)) {
      if (entry.path().extension() == ".rawlog") log = entry.path().string();
    }
    if (!log.empty() && fs::file_size(log) > 1000) break;
  }
  ASSERT_FALSE(log.empty());
  registerPerceptionClasses();
  std::stringstream said;
  said << std::ifstream(dir / "said.txt").rdbuf();
  RawlogReader reader(log);
  std::map<std::string, int> count;
  bool simulated = false;
  while (const auto observation = reader.next()) {
    ++count[observation->sensorLabel];
    const auto* comment = dynamic_cast<const mrpt::obs::CObservationComment*>(observation.get());
    simulated = simulated || (comment && comment->text.rfind(kSimulatedText, 0) == 0);
  }
  EXPECT_EQ(reader.end(), RawlogReader::End::kClean) << reader.endMessage();
  EXPECT_TRUE(simulated);
  for (const char* label : {"LIDAR_TOP", "CAMERA", "EGO_POSE"}) {
    EXPECT_GT(count[label], 0) << label << "; the grabber said: " << said.str();
  }
  fs::remove_all(dir);
}

}  // namespace
}  // namespace perception
