#include "libperception/doctor/LogSurvey.h"

#include <gtest/gtest.h>

#include <chrono>

#include "libperception/sensors/observations/CObservationLidarScan.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"

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

/// Check of the demo's lidar after an error of its mounting and of its clock.
std::optional<MotionCheck> checkOf(double yaw, double left, double late) {
  registerPerceptionClasses();
  RawlogReader reader(kLog);
  LogSurvey survey;
  while (const auto observation = reader.next()) {
    if (auto* scan = dynamic_cast<CObservationLidarScan*>(observation.get())) {
      mrpt::poses::CPose3D pose;
      scan->getSensorPose(pose);
      Pose3 wrong = toPose3(pose);
      wrong.linear() = makePose(0, 0, 0, yaw).linear() * wrong.linear();
      wrong.translation().y() += left;
      scan->setSensorPose(toMrpt(wrong));
      scan->timestamp +=
          std::chrono::duration_cast<mrpt::Clock::duration>(std::chrono::duration<double>(late));
    }
    survey.look(*observation);
  }
  return survey.motionCheck(survey.sensors().at("LIDAR_TOP"));
}

/// Found within the tolerance, or said not to be observable.
void expectFound(const MotionCheck::Value& value, double error, double tolerance) {
  if (value.observable()) {
    EXPECT_NEAR(value.error, error, tolerance);
  } else {
    EXPECT_FALSE(value.isWrong());
  }
}

TEST(LogSurvey, MountingAndClockOfTheSimulatedLidarAgreeWithThePoses) {
  const auto check = checkOf(0, 0, 0);
  ASSERT_TRUE(check);
  EXPECT_TRUE(check->yaw.observable());
  for (const auto& v :
       {check->yaw, check->pitch, check->roll, check->ahead, check->left, check->clock})
    EXPECT_FALSE(v.isWrong()) << v.error << " +- " << v.sigma;
}

TEST(LogSurvey, LidarTurnedShiftedAndLateIsFoundOrSaidNotToBeObservable) {
  const auto check = checkOf(radians(5), 0.2, 0.08);
  ASSERT_TRUE(check);
  EXPECT_TRUE(check->yaw.isWrong());
  expectFound(check->yaw, radians(5), radians(1));
  expectFound(check->left, 0.2, 0.1);
  expectFound(check->clock, 0.08, 0.02);
}

TEST(LogSurvey, PitchByMotionThatTheGroundContradictsIsNotObservable) {
  const auto survey = surveyWith(0, 0, 0);
  SensorFacts facts = survey.sensors().at("LIDAR_TOP");
  ASSERT_TRUE(survey.motionCheck(facts)->pitch.observable());
  for (GroundPlane& plane : facts.planes) plane.a += std::tan(radians(2));
  EXPECT_FALSE(survey.motionCheck(facts)->pitch.observable());
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
