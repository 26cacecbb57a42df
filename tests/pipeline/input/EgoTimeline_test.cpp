#include "libperception/pipeline/input/EgoTimeline.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <cmath>
#include <string>

#include "libperception/sensors/frames/ToObservation.h"
#include "libperception/sensors/observations/Conversions.h"
#include "tests/support/StartStamp.h"

namespace perception {
namespace {

using test::kStart;

/// A timeline and the events it wrote.
struct Timeline {
  EventLog events;
  EgoTimeline ego;

  explicit Timeline(const EgoPoseParams& params = {}) : ego(params, events) {}
  void add(double t, double x, double y = 0, double yaw = 0,
           const std::string& label = kEgoPoseLabel) {
    EgoState pose;
    pose.stamp = kStart + t;
    pose.T_world_ego = makePose(x, y, 0, yaw);
    ego.add(*poseObservation(pose, label));
  }
  void addWheels(double t, double speed) {
    mrpt::obs::CObservationOdometry wheels;
    wheels.sensorLabel = "WHEELS";
    wheels.timestamp = fromStamp(kStart + t);
    wheels.hasVelocities = true;
    wheels.velocityLocal.vx = speed;
    ego.add(wheels);
  }
  EgoState at(double t) { return ego.at(kStart + t); }
  std::size_t gaps() const {
    const auto found = events.counts().find(event_kind::kEgoGap);
    return found == events.counts().end() ? 0 : found->second;
  }
  std::string text() const { return events.text(kStart); }
};

double xOf(const EgoState& state) { return state.T_world_ego.translation().x(); }

TEST(EgoTimeline, WithoutAnyPoseTheVehicleStandsAtTheOriginAndThatIsSaidOnce) {
  Timeline timeline;
  for (const double t : {0.0, 0.1, 7.0}) {
    const EgoState state = timeline.at(t);
    EXPECT_TRUE(state.T_world_ego.isApprox(Pose3::Identity()));
    EXPECT_EQ(state.velocity, Vector2::Zero());
    EXPECT_EQ(state.stamp, kStart + t);
  }
  EXPECT_EQ(timeline.gaps(), 1U);
  EXPECT_EQ(timeline.events.warnings(), 1U);
}

TEST(EgoTimeline, AParkedVehicleHasTheLeastUncertaintyOfTheConfiguration) {
  EgoPoseParams params;
  params.minimum = {0.3, 0.02, 0.01};
  Timeline timeline(params);
  EXPECT_EQ(timeline.at(0).uncertainty.sigma_xy, 0.3);
  EXPECT_EQ(timeline.at(0).uncertainty.sigma_yaw, 0.02);
}

TEST(EgoTimeline, AmongPosesNothingIsReported) {
  Timeline timeline;
  for (int k = 0; k <= 20; ++k) timeline.add(0.1 * k, k);
  EXPECT_NEAR(xOf(timeline.at(0.55)), 5.5, 1e-9);
  EXPECT_NEAR(xOf(timeline.at(2.15)), 21.5, 1e-6);  // within `extrapolation`
  EXPECT_EQ(timeline.gaps(), 0U);
}

TEST(EgoTimeline, AGapIsBridgedWithTheLastVelocityAndGrowingUncertainty) {
  Timeline timeline;
  for (int k = 0; k <= 20; ++k) timeline.add(0.1 * k, k);  // 10 m/s until 2 s
  const EgoState soon = timeline.at(3), late = timeline.at(5);
  EXPECT_NEAR(xOf(soon), 30, 1e-6);
  EXPECT_NEAR(xOf(late), 50, 1e-6);
  EXPECT_EQ(late.stamp, kStart + 5.0);
  const double least = PoseUncertainty{}.sigma_xy;
  EXPECT_NEAR(soon.uncertainty.sigma_xy, least + 1, 1e-9);
  EXPECT_NEAR(late.uncertainty.sigma_xy, least + 3, 1e-9);
}

TEST(EgoTimeline, EachGapIsReportedOnce) {
  Timeline timeline;
  timeline.add(0, 0);
  timeline.add(0.1, 1);
  for (const double t : {1.0, 1.1, 1.2}) timeline.at(t);
  EXPECT_EQ(timeline.gaps(), 1U);
  EXPECT_NE(timeline.text().find("no ego pose for 0.900 s"), std::string::npos) << timeline.text();
  timeline.add(1.3, 13);
  timeline.at(1.3);
  timeline.at(2.3);
  EXPECT_EQ(timeline.gaps(), 2U);
}

TEST(EgoTimeline, BeforeTheFirstPoseTheVehicleIsExtrapolatedFromThatOne) {
  Timeline timeline;
  // It stands for a second, then drives at 10 m/s.
  for (int k = 0; k <= 10; ++k) timeline.add(0.1 * k, 0);
  for (int k = 11; k <= 30; ++k) timeline.add(0.1 * k, k - 10);
  const EgoState before = timeline.at(-0.5);
  EXPECT_NEAR(xOf(before), 0, 1e-9);
  EXPECT_NEAR(before.uncertainty.sigma_xy, PoseUncertainty{}.sigma_xy + 0.5, 1e-9);
  EXPECT_NE(timeline.text().find("no ego pose for 0.500 s"), std::string::npos) << timeline.text();
}

TEST(EgoTimeline, PosesThatComeLateOrOutOfOrderCount) {
  Timeline timeline;
  timeline.add(0, 0);
  timeline.add(1.0, 20);
  EXPECT_NEAR(xOf(timeline.at(0.5)), 10, 1e-9);
  timeline.add(0.5, 5);
  EXPECT_NEAR(xOf(timeline.at(0.5)), 5, 1e-9);
}

TEST(EgoTimeline, ATurnThroughPiTakesTheShortWay) {
  Timeline timeline;
  timeline.add(0, 0, 0, kPi - 0.02);
  timeline.add(0.1, 0, 0, -kPi + 0.02);
  const EgoState state = timeline.at(0.05);
  EXPECT_NEAR(std::abs(yawOf(state.T_world_ego)), kPi, 1e-9);
  EXPECT_NEAR(state.yaw_rate, 0.4, 1e-6);
}

TEST(EgoTimeline, NothingSeenForTooLongIsABlindGapOnlyWithoutPoses) {
  EgoPoseParams params;
  params.blind_gap = 2;
  Timeline blind(params), posed(params);
  posed.add(0, 0);
  EXPECT_FALSE(blind.ego.isBlindGap(kStart + 100.0)) << "nothing was seen before";
  for (Timeline* timeline : {&blind, &posed}) timeline->ego.setSeen(kStart);
  EXPECT_FALSE(blind.ego.isBlindGap(kStart + 2.0));
  EXPECT_FALSE(blind.ego.isBlindGap(kStart + -5.0)) << "out of order";
  EXPECT_TRUE(blind.ego.isBlindGap(kStart + 2.001));
  EXPECT_FALSE(posed.ego.isBlindGap(kStart + 2.001));
  EXPECT_EQ(blind.gaps(), 1U);
  EXPECT_EQ(posed.gaps(), 0U);
}

TEST(EgoTimeline, TheFrameOfALogWithPosesNeverChanges) {
  Timeline timeline;
  EXPECT_FALSE(timeline.ego.changedFrame(kStart));
  timeline.ego.setSeen(kStart);
  timeline.add(0.1, 100);
  EXPECT_FALSE(timeline.ego.changedFrame(kStart + 0.1));
  EXPECT_EQ(timeline.gaps(), 0U);
}

TEST(EgoTimeline, PosesAfterWheelsAloneAreAnotherFrameWhichIsToldOnce) {
  Timeline timeline;
  for (int k = 0; k < 3; ++k) timeline.addWheels(0.1 * k, 5);
  EXPECT_FALSE(timeline.ego.changedFrame(kStart + 0.2));
  EXPECT_GT(xOf(timeline.at(0.2)), 0.5);
  timeline.ego.setSeen(kStart + 0.2);
  timeline.add(0.3, 100);
  EXPECT_TRUE(timeline.ego.changedFrame(kStart + 0.3));
  EXPECT_FALSE(timeline.ego.changedFrame(kStart + 0.4));
  EXPECT_EQ(timeline.gaps(), 1U);
  EXPECT_NEAR(xOf(timeline.at(0.3)), 100, 1e-9);
}

TEST(EgoTimeline, AFrameThatChangesBeforeAnythingWasSeenVoidsNothing) {
  Timeline timeline;
  timeline.addWheels(0, 5);
  timeline.add(0.1, 100);
  EXPECT_FALSE(timeline.ego.changedFrame(kStart + 0.1));
  timeline.ego.setSeen(kStart + 0.1);
  EXPECT_FALSE(timeline.ego.changedFrame(kStart + 0.2));
}

TEST(EgoTimeline, ThePosesOfTheProperLabelAreAnotherFrameThanThoseOfAnother) {
  Timeline timeline;
  timeline.add(0, 0, 0, 0, "INS");
  timeline.ego.changedFrame(kStart);
  timeline.ego.setSeen(kStart);
  timeline.add(0.1, 1000);
  EXPECT_TRUE(timeline.ego.changedFrame(kStart + 0.1));
  EXPECT_NEAR(xOf(timeline.at(0.1)), 1000, 1e-9);
}

TEST(EgoTimeline, ClearedItKnowsNothingOfBefore) {
  Timeline timeline;
  timeline.at(0);  // "no ego pose yet"
  timeline.add(0, 0);
  timeline.add(0.1, 1);
  timeline.at(5);  // a gap
  timeline.ego.setSeen(kStart + 5.0);
  ASSERT_EQ(timeline.gaps(), 2U);
  timeline.ego.clear();
  EXPECT_FALSE(timeline.ego.isBlindGap(kStart + 100.0));
  EXPECT_TRUE(timeline.at(1).T_world_ego.isApprox(Pose3::Identity()));
  EXPECT_EQ(timeline.gaps(), 3U) << "no pose of the new epoch";
  timeline.add(1, 0);
  timeline.at(9);
  EXPECT_EQ(timeline.gaps(), 4U) << "a gap of the new epoch";
}

TEST(EgoTimeline, ARunOfJumpsIsOneEventAndARelocationStartsTracksAnew) {
  Timeline timeline;
  for (int k = 0; k < 10; ++k) timeline.add(0.1 * k, k);
  timeline.ego.setSeen(kStart + 0.9);
  timeline.add(1.0, 5000);
  timeline.add(1.1, 1e300);
  timeline.add(1.2, -7000);
  EXPECT_EQ(timeline.events.counts().at(event_kind::kEgoJump), 2U) << timeline.text();
  timeline.add(1.3, 13);
  EXPECT_FALSE(timeline.ego.changedFrame(kStart + 1.3));
  EXPECT_NEAR(xOf(timeline.at(1.2)), 12, 1e-9);
  for (int k = 14; k < 24; ++k) timeline.add(0.1 * k, 5000 + k);
  EXPECT_EQ(timeline.events.counts().at(event_kind::kEgoJump), 4U) << timeline.text();
  EXPECT_TRUE(timeline.ego.changedFrame(kStart + 2.3));
  EXPECT_NEAR(xOf(timeline.at(2.3)), 5023, 1e-9);
}

}  // namespace
}  // namespace perception
