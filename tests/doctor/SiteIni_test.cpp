#include "libperception/doctor/SiteIni.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "libperception/doctor/DoctorReport.h"
#include "libperception/pipeline/PipelineSetup.h"
#include "libperception/scene/OutputFile.h"
#include "libperception/sensors/CObservationLidarScan.h"
#include "libperception/sensors/RawlogReader.h"
#include "libperception/sensors/registerClasses.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

/// `lift` [m]: of the lidars in the log, by mistake.
LogSurvey surveyOf(const std::string& name, double lift = 0) {
  registerPerceptionClasses();
  RawlogReader reader(PERCEPTION_SOURCE_DIR "/rawlogs/" + name + ".rawlog");
  LogSurvey survey;
  while (const auto observation = reader.next()) {
    if (auto* scan = dynamic_cast<CObservationLidarScan*>(observation.get()))
      scan->sensor_pose.z_incr(lift);
    survey.look(*observation);
  }
  return survey;
}

PipelineSetup setupOf(const LogSurvey& survey) {
  const fs::path dir = fs::path(testing::TempDir()) / "perception_site_ini";
  createFolder(dir.string());
  const std::string ini = PERCEPTION_SOURCE_DIR "/ini";
  const std::string file = (dir / "site.ini").string();
  writeFile(file,
            siteIni(survey, {ini + "/classes.ini", ini + "/models/lidar_recordings.json"}, "log"));
  Config config = Config::fromFile(file);
  const PipelineSetup setup = PipelineSetup::read(config);
  config.finish();
  fs::remove_all(dir);
  return setup;
}

TEST(SiteIni, OfEveryShippedLogIsReadWithoutFault) {
  for (const char* name : {"demo", "ibeo", "radar", "gnss", "camera"}) {
    SCOPED_TRACE(name);
    const auto survey = surveyOf(name);
    const PipelineSetup setup = setupOf(survey);
    for (const auto& [label, facts] : survey.sensors())
      EXPECT_EQ(setup.sensorOf(label).has_value(), facts.kind != "image") << label;
  }
}

TEST(SiteIni, NamesWhatIsFound) {
  const PipelineSetup setup = setupOf(surveyOf("demo"));
  EXPECT_EQ(setup.run.sensors, "C+L");
  const auto& lidar = setup.sensors[*setup.sensorOf("LIDAR_TOP")];
  EXPECT_EQ(lidar.params.kind, "lidar");
  EXPECT_EQ(lidar.params.range_max, 50);
  EXPECT_FALSE(lidar.params.pose);
}

TEST(SiteIni, WrongMountingIsCorrectedThere) {
  const PipelineSetup setup = setupOf(surveyOf("demo", 0.5));
  const auto& pose = setup.sensors[*setup.sensorOf("LIDAR_TOP")].params.pose;
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->translation().z(), 1.73, 0.05);
}

TEST(DoctorReport, SaysWhatIsMissing) {
  const auto findings = findingsOf(surveyOf("radar"));
  const std::string text = reportText(findings);
  EXPECT_NE(text.find("no lidar"), std::string::npos);
  EXPECT_EQ(text.find("no radar"), std::string::npos);
}

}  // namespace
}  // namespace perception
