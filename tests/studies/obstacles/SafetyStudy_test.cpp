#include "studies/obstacles/SafetyStudy.h"

#include <gtest/gtest.h>

#include "libperception/app/simulate/SimulateApp.h"
#include "libperception/core/Error.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

const std::string kIni = PERCEPTION_SOURCE_DIR "/ini/";

// A second behind a car in slush or, dry, in clear air.
std::string slushLog(const std::string& folder, bool dry) {
  const std::string log = folder + (dry ? "/dry.rawlog" : "/slush.rawlog");
  std::vector<std::string> args = {"perception-simulate",
                                   "-c",
                                   kIni + "scenarios/slush.ini",
                                   "--set",
                                   "scenario.duration=1.2",
                                   "-o",
                                   log};
  if (dry) args.insert(args.end(), {"--weather", kIni + "weather/sunny.ini"});
  std::vector<const char*> argv;
  for (const std::string& a : args) argv.push_back(a.c_str());
  SimulateApp run;
  EXPECT_EQ(runApp(run, static_cast<int>(argv.size()), argv.data()), 0);
  return log;
}

TEST(SafetyStudy, SprayStopsEuclideanClustersAndDryAirDoesNot) {
  const test::TemporaryFolder folder;
  SafetyOptions options;
  options.config = kIni + "kitti.ini";
  options.logs = {slushLog(folder.path(), false), slushLog(folder.path(), true)};
  const StudyReport report = safetyStudy(options, 1);
  const StudyTable& stops = report.tables.front();
  ASSERT_EQ(stops.rows.size(), 9u);  // three monitors for each log and for both
  EXPECT_EQ(stops.rows[0][0], "slush");
  EXPECT_GE(std::stoi(stops.rows[0][4]), 5);
  EXPECT_EQ(stops.rows[3][0], "dry");
  EXPECT_EQ(stops.rows[3][4], "0");
  EXPECT_EQ(stops.rows[4][4], "0");
  EXPECT_LE(std::stoi(stops.rows[5][4]), 4) << "until the car ahead has a speed";
}

TEST(SafetyStudy, ALogWithoutLabelsIsRefused) {
  SafetyOptions options;
  options.logs = {PERCEPTION_SOURCE_DIR "/rawlogs/demo.rawlog"};
  options.config = kIni + "demo.ini";
  EXPECT_THROW(safetyStudy(options, 1), DataError);
}

}  // namespace
}  // namespace perception
