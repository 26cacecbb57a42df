#include "studies/weather/TrustStudy.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "libperception/app/simulate/SimulateApp.h"
#include "libperception/core/Error.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

const std::string kTrustIni = PERCEPTION_SOURCE_DIR "/ini/";

// Six tenths of a second of a simulated snowfall, seen by a vehicle with one lidar.
std::string snowLog(const std::string& folder) {
  const std::string log = folder + "/snow.rawlog";
  const std::vector<std::string> args = {"perception-simulate",
                                         "-c",
                                         kTrustIni + "scenarios/C.ini",
                                         "--vehicle",
                                         kTrustIni + "vehicles/kitti.ini",
                                         "--weather",
                                         kTrustIni + "weather/snow_2.5.ini",
                                         "--set",
                                         "scenario.duration=0.6",
                                         "-o",
                                         log};
  std::vector<const char*> argv;
  for (const std::string& a : args) argv.push_back(a.c_str());
  SimulateApp run;
  EXPECT_EQ(runApp(run, static_cast<int>(argv.size()), argv.data()), 0);
  return log;
}

TEST(TrustStudy, FindsSimulatedSnowByItsLabels) {
  const test::TemporaryFolder folder;
  TrustOptions options;
  options.log = snowLog(folder.path());
  options.config = kTrustIni + "kitti.ini";
  const StudyReport report = trustStudy(options);
  EXPECT_EQ(report.data.rfind("simulated", 0), 0u);
  const StudyTable& kinds = report.tables.front();
  ASSERT_EQ(kinds.rows.size(), 2u);
  EXPECT_EQ(kinds.rows[1][0], "snow");
  EXPECT_GT(std::stoi(kinds.rows[1][1]), 100);
  EXPECT_GT(std::stod(kinds.rows[0][6]), 0.5);  // F1
  options.settings = {"weather.filter=off"};
  EXPECT_EQ(trustStudy(options).tables.front().rows[1][2], "0");  // all is trusted
}

TEST(TrustStudy, ALogWithoutLabelsIsRefused) {
  TrustOptions options;
  options.log = PERCEPTION_SOURCE_DIR "/rawlogs/demo.rawlog";
  options.config = kTrustIni + "demo.ini";
  EXPECT_THROW(trustStudy(options), DataError);
}

}  // namespace
}  // namespace perception
