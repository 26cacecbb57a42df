#include "libperception/doctor/LogSurvey.h"

#include <gtest/gtest.h>

#include "libperception/sensors/CObservationLidarScan.h"
#include "libperception/sensors/Conversions.h"
#include "libperception/sensors/RawlogReader.h"
#include "libperception/sensors/registerClasses.h"

namespace perception {
namespace {

const std::string kLog = PERCEPTION_SOURCE_DIR "/rawlogs/demo.rawlog";

/// Survey of the demo with the lidar's mounting in the log turned and lifted.
LogSurvey surveyWith(double pitch, double roll, double dz) {
  registerPerceptionClasses();
  RawlogReader reader(kLog);
  LogSurvey survey;
  while (const auto observation = reader.next()) {
    if (auto* scan = dynamic_cast<CObservationLidarScan*>(observation.get())) {
      mrpt::poses::CPose3D pose;
      scan->getSensorPose(pose);
      const Pose3 right = toPose3(pose);
      const Vector3 t = right.translation();
      scan->setSensorPose(toMrpt(makePose(t.x(), t.y(), t.z() + dz, yawOf(right),
                                          pitchOf(right) + pitch, rollOf(right) + roll)));
    }
    survey.look(*observation);
  }
  return survey;
}

TEST(LogSurvey, MountingOfTheSimulatedLidarIsAsTheLogSays) {
  const auto survey = surveyWith(0, 0, 0);
  const auto found = groundMounting(survey.sensors().at("LIDAR_TOP"));
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->wrong());
  EXPECT_NEAR(found->height_error, 0, 0.02);
}

TEST(LogSurvey, WrongMountingIsFoundAndCorrected) {
  const auto right = surveyWith(0, 0, 0).sensors().at("LIDAR_TOP").T_ego_sensor;
  const auto survey = surveyWith(radians(5), radians(-5), 0.2);
  const auto found = groundMounting(survey.sensors().at("LIDAR_TOP"));
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->wrong());
  EXPECT_NEAR(degrees(found->pitch_error), 5, 1);
  EXPECT_NEAR(degrees(found->roll_error), -5, 1);
  EXPECT_NEAR(found->height_error, 0.2, 0.1);
  EXPECT_NEAR(found->T_ego_sensor.translation().z(), right.translation().z(), 0.1);
}

TEST(LogSurvey, PlanesThatDifferAreNoGround) {
  SensorFacts facts;
  for (int i = 0; i < 9; ++i) facts.planes.push_back({0.02 * (i % 3), 0, 0.4, 0.1, true});
  const auto found = groundMounting(facts);
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->steady());
  EXPECT_FALSE(found->wrong());
}

TEST(LogSurvey, GapsAndRatesComeFromSortedStamps) {
  SensorFacts facts;
  for (const int tenths : {0, 2, 1, 3, 13, 14})
    facts.stamps.push_back(Stamp{1000000000000 + tenths * 100000000LL});
  EXPECT_NEAR(facts.rate(), 10, 1e-6);
  EXPECT_NEAR(facts.longestGap(), 1, 1e-6);
}

}  // namespace
}  // namespace perception
