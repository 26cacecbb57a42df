#include "libperception/doctor/SiteIni.h"

#include <gtest/gtest.h>

#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <filesystem>

#include "libperception/doctor/DoctorReport.h"
#include "libperception/pipeline/PipelineSetup.h"
#include "libperception/scene/files/OutputFile.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/frames/ToObservation.h"
#include "libperception/sensors/observations/CObservationLidarScan.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"

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

TEST(SiteIni, LidarsThatTellShapesSeeRoundCorners) {
  const auto survey = surveyOf("demo");
  const auto textWith = [&](const std::string& model) {
    return siteIni(survey, {"classes.ini", model}, "log");
  };
  EXPECT_NE(textWith("model.json").find("corner_radius = 0.3\n"), std::string::npos);
  EXPECT_EQ(textWith("").find("corner_radius"), std::string::npos);
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

/// A one-layer scanner of 180 deg in a room of 5 m.
mrpt::obs::CObservation2DRangeScan planarScan(const std::string& label, double height) {
  mrpt::obs::CObservation2DRangeScan scan;
  scan.sensorLabel = label;
  scan.timestamp = fromStamp(Stamp{1'000'000'000'000});
  scan.aperture = static_cast<float>(kPi);
  scan.maxRange = 30;
  scan.sensorPose = mrpt::poses::CPose3D(0.2, 0, height, 0, 0, 0);
  scan.resizeScan(181);
  for (std::size_t i = 0; i < 181; ++i) scan.setScanRange(i, 5), scan.setScanRangeValidity(i, true);
  return scan;
}

TEST(SiteIni, OneScannerOfOneLayerHasItsFieldOfViewAndAHeight) {
  LogSurvey survey;
  survey.look(planarScan("LASER", 0));
  const PipelineSetup setup = setupOf(survey);
  const auto sensor = setup.sensorOf("LASER");
  ASSERT_TRUE(sensor);
  const auto& params = setup.sensors.at(*sensor).params;
  ASSERT_TRUE(params.pose);
  EXPECT_NEAR(params.pose->translation().z(), 0.5, 1e-9);  // a floor sees no objects
  EXPECT_NEAR(degrees(params.fov), 182, 2);

  LogSurvey high;
  high.look(planarScan("LASER", 0.8));
  const PipelineSetup known = setupOf(high);
  EXPECT_FALSE(known.sensors.at(*known.sensorOf("LASER")).params.pose);
}

// sensor_msgs/LaserScan is imported as a cloud.
TEST(SiteIni, ACloudInOnePlaneIsThatOfAScannerOfOneLayer) {
  const auto frame = frameFromObservation(planarScan("LASER", 0.8));
  ASSERT_TRUE(frame);
  LogSurvey survey;
  survey.look(*observationFromFrame(*frame));
  const SensorFacts& facts = survey.sensors().at("LASER");
  EXPECT_TRUE(facts.planar);
  LogSurvey same;
  same.look(planarScan("LASER", 0.8));
  EXPECT_EQ(siteIni(survey, {}, "log"), siteIni(same, {}, "log"));

  SensorFrame raised = *frame;
  std::get<LidarCloud>(raised.data).z[40] = 0.2F;
  survey.look(*observationFromFrame(raised));
  EXPECT_FALSE(survey.sensors().at("LASER").planar);
}

TEST(SiteIni, SeveralScannersOfOneLayerAreMerged) {
  LogSurvey survey;
  survey.look(planarScan("LEFT", 0.6));
  survey.look(planarScan("RIGHT", 0.6));
  const PipelineSetup setup = setupOf(survey);
  ASSERT_TRUE(setup.sensorOf("LEFT"));
  EXPECT_EQ(setup.sensorOf("LEFT"), setup.sensorOf("RIGHT"));
  EXPECT_EQ(setup.sensors.at(*setup.sensorOf("LEFT")).label, "SCANNERS");
}

TEST(SiteIni, NamesWhatIsFound) {
  const PipelineSetup setup = setupOf(surveyOf("demo"));
  EXPECT_EQ(setup.run.sensors, "C+L");
  const auto& lidar = setup.sensors[*setup.sensorOf("LIDAR_TOP")];
  EXPECT_EQ(lidar.params.kind, "lidar");
  EXPECT_EQ(lidar.params.range_max, 50);
  EXPECT_FALSE(lidar.params.pose);
}

TEST(SiteIni, FieldOfViewIsThatOfTheReturns) {
  for (const double half : {60., 170.}) {
    SensorFrame frame;
    frame.sensor = "LIDAR_FRONT";
    frame.stamp = Stamp::fromSeconds(1e9);
    LidarCloud cloud;
    for (double bearing = -half; bearing <= half; bearing += 0.1) {
      const double angle = radians(bearing);
      cloud.x.push_back(static_cast<float>(20 * std::cos(angle)));
      cloud.y.push_back(static_cast<float>(20 * std::sin(angle)));
      cloud.z.push_back(0);
    }
    frame.data = cloud;
    LogSurvey survey;
    survey.look(*observationFromFrame(frame));
    const PipelineSetup setup = setupOf(survey);
    EXPECT_NEAR(degrees(setup.sensors[*setup.sensorOf("LIDAR_FRONT")].params.fov),
                half == 60 ? 120 : 360, 1);
  }
}

TEST(SiteIni, PositionsOfNamelessObjectsAreReadWithoutFault) {
  LogSurvey survey;
  for (int k = 0; k < 10; ++k) {
    ObjectDetections found;
    ObjectDetection& object = found.objects.emplace_back();
    object.label = "object";
    object.score = 1;
    object.space_box = ObjectDetection::SpaceBox{Vector3(20 + k, 3, 0), 0, 0.1, 0.1, 0.1};
    SensorFrame frame;
    frame.sensor = "RECEIVER";
    frame.stamp = Stamp::fromSeconds(1e9 + 0.1 * k);
    frame.data = found;
    survey.look(*observationFromFrame(frame));
  }
  const PipelineSetup setup = setupOf(survey);
  ASSERT_TRUE(setup.sensorOf("RECEIVER"));
  EXPECT_EQ(setup.sensors[*setup.sensorOf("RECEIVER")].params.kind, "positions");
}

TEST(SiteIni, IsEmptyWhereNoSensorCanBeUsed) {
  LogSurvey survey;
  mrpt::obs::CObservationOdometry wheels;
  wheels.timestamp = mrpt::Clock::now();
  survey.look(wheels);
  EXPECT_EQ(siteIni(survey, {"classes.ini", "model.json"}, "log"), "");
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
