#include "libperception/sensors/ego/EgoPose.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <algorithm>
#include <limits>

#include "libperception/sensors/frames/ToObservation.h"
#include "libperception/sensors/observations/Conversions.h"

namespace perception {
namespace {

constexpr Stamp kDriveStart{1'317'038'400'000'000'000};

EgoState pose(double t, double x, double y, double yaw) {
  EgoState state;
  state.stamp = kDriveStart + t;
  state.T_world_ego = makePose(x, y, 0, yaw);
  return state;
}

/// Ten seconds of a circle of 20 m radius at 10 m/s, a pose every 0.1 s.
EgoState onCircle(double t) {
  const double turned = 0.5 * t;
  return pose(t, 20 * std::sin(turned), 20 * (1 - std::cos(turned)), turned);
}

TEST(EgoPose, ReturnsThePosesThemselvesAtTheirStamps) {
  EgoPose ego;
  for (int k = 0; k <= 50; ++k) ego.add(onCircle(0.1 * k));
  for (int k = 0; k <= 50; ++k) {
    const auto state = ego.at(kDriveStart + 0.1 * k);
    ASSERT_TRUE(state);
    EXPECT_EQ(state->T_world_ego.matrix(), onCircle(0.1 * k).T_world_ego.matrix());
    EXPECT_EQ(state->stamp.ns, (kDriveStart + 0.1 * k).ns);
  }
}

TEST(EgoPose, InterpolatesPositionAndAttitude) {
  EgoPose ego;
  for (int k = 0; k <= 50; ++k) ego.add(onCircle(0.1 * k));
  for (double t = 0.53; t < 4.5; t += 0.37) {
    const auto state = ego.at(kDriveStart + t);
    ASSERT_TRUE(state);
    const EgoState truth = onCircle(t);
    // The chord is at most s^2 / 8r from the arc: (1 m)^2 / (8 * 20 m) = 6.3 mm.
    EXPECT_LT((state->T_world_ego.translation() - truth.T_world_ego.translation()).norm(), 0.0063);
    EXPECT_NEAR(yawOf(state->T_world_ego), yawOf(truth.T_world_ego), 1e-9);
    EXPECT_NEAR(state->velocity.norm(), 10, 0.02);
    EXPECT_NEAR(state->yaw_rate, 0.5, 1e-6);
  }
}

TEST(EgoPose, ContinuesForAMomentWithTheLastVelocity) {
  EgoPose ego;
  ego.add(pose(0, 0, 0, 0));
  ego.add(pose(0.1, 1, 0, 0.01));
  const auto state = ego.at(kDriveStart + 0.25);
  ASSERT_TRUE(state);
  EXPECT_NEAR(state->T_world_ego.translation().x(), 2.5, 1e-9);
  EXPECT_NEAR(yawOf(state->T_world_ego), 0.025, 1e-9);
  EXPECT_TRUE(ego.at(kDriveStart + 0.3));
  EXPECT_FALSE(ego.at(kDriveStart + 0.31));
  EXPECT_NEAR(ego.at(kDriveStart + -0.1)->T_world_ego.translation().x(), -1, 1e-9);
  EXPECT_FALSE(ego.at(kDriveStart + -0.3));
}

TEST(EgoPose, FastPosesDoNotTurnTheirNoiseIntoVelocity) {
  EgoPose ego;
  for (int k = 0; k <= 200; ++k)
    ego.add(pose(0.005 * k, 0.05 * k + (k % 2 == 0 ? 0.01 : -0.01), 0, 0));
  // Steps of 5 ms with +-1 cm of noise would read 6 to 14 m/s; over 0.1 s the noise is at most 0.2
  // m/s.
  EXPECT_NEAR(ego.at(kDriveStart + 0.5025)->velocity.x(), 10, 0.21);
}

TEST(EgoPose, OrderOfArrivalDoesNotMatter) {
  EgoPose in_order, shuffled;
  for (int k = 0; k <= 20; ++k) in_order.add(onCircle(0.1 * k));
  for (const int k : {0, 2, 1, 4, 3, 5, 8, 7, 6, 9, 10, 12, 11, 13, 14, 16, 15, 17, 18, 20, 19}) {
    shuffled.add(onCircle(0.1 * k));
  }
  EXPECT_EQ(shuffled.accepted(), 21U);
  for (double t = 0; t < 2; t += 0.13) {
    EXPECT_EQ(in_order.at(kDriveStart + t)->T_world_ego.matrix(),
              shuffled.at(kDriveStart + t)->T_world_ego.matrix());
  }
}

TEST(EgoPose, RejectsJumpsAndBelievesARelocation) {
  EgoPose ego;
  for (int k = 0; k <= 10; ++k) ego.add(pose(0.1 * k, k, 0, 0));
  ego.add(pose(1.1, 500, 0, 0));
  EXPECT_EQ(ego.rejectedJumps(), 1U);
  ego.add(pose(1.2, 12, 0, 0));
  EXPECT_EQ(ego.accepted(), 12U);
  EXPECT_NEAR(ego.at(kDriveStart + 1.1)->T_world_ego.translation().x(), 11, 1e-9);
  for (int k = 0; k < 10; ++k) ego.add(pose(1.3 + 0.1 * k, 800 + k, 0, 0));
  EXPECT_NEAR(ego.at(kDriveStart + 2.2)->T_world_ego.translation().x(), 809, 1e-9);
  EXPECT_EQ(ego.relocations(), 1U);
  EXPECT_EQ(ego.frameEpoch(), 1U) << "nothing says that the two places are of one world frame";
}

TEST(EgoPose, MemoryIsBounded) {
  EgoPoseParams params;
  params.history = 2;
  EgoPose ego(params);
  for (int k = 0; k <= 1000; ++k) ego.add(pose(0.1 * k, 0, 0, 0));
  EXPECT_TRUE(ego.at(kDriveStart + 98.0));
  EXPECT_FALSE(ego.at(kDriveStart + 97.0));
  ego.add(pose(50, 0, 0, 0));
  EXPECT_EQ(ego.rejectedOther(), 1U);
}

TEST(EgoPose, TakesTheWantedLabel) {
  EgoPose first_label, preferred, chosen([] {
    EgoPoseParams p;
    p.label = "GPS";
    return p;
  }());
  const auto gps = poseObservation(pose(0, 1, 0, 0), "GPS"),
             other = poseObservation(pose(0, 2, 0, 0), "INS"),
             proper = poseObservation(pose(0.05, 3, 0, 0));
  for (const auto& o : {other, gps}) first_label.add(*o);
  EXPECT_EQ(first_label.at(kDriveStart)->T_world_ego.translation().x(), 2);
  for (const auto& o : {other, gps, proper}) {
    preferred.add(*o);
    chosen.add(*o);
  }
  EXPECT_EQ(preferred.at(kDriveStart)->T_world_ego.translation().x(), 3);
  EXPECT_EQ(chosen.at(kDriveStart)->T_world_ego.translation().x(), 1);
}

TEST(EgoPose, UncertaintyIsThatOfTheLogButNotBelowTheMinimum) {
  EgoPose ego;
  EgoState sure = pose(0, 0, 0, 0), unsure = pose(1, 0, 0, 0);
  sure.uncertainty = {0, 0, 0};
  unsure.uncertainty = {0.5, 0.1, 0.02};
  ego.add(*poseObservation(sure));
  ego.add(*poseObservation(unsure));
  const PoseUncertainty minimum;
  EXPECT_EQ(ego.at(sure.stamp)->uncertainty.sigma_xy, minimum.sigma_xy);
  EXPECT_EQ(ego.at(sure.stamp)->uncertainty.sigma_yaw, minimum.sigma_yaw);
  EXPECT_NEAR(ego.at(unsure.stamp)->uncertainty.sigma_xy, 0.5, 1e-12);
  EXPECT_NEAR(ego.at(unsure.stamp)->uncertainty.sigma_yaw, 0.1, 1e-12);
  EXPECT_NEAR(ego.at(unsure.stamp)->uncertainty.sigma_pitch, 0.02, 1e-12);
}

TEST(EgoPose, BadPosesAreCounted) {
  EgoPose ego;
  mrpt::obs::CObservationRobotPose bad;
  bad.timestamp = INVALID_TIMESTAMP;
  ego.add(bad);
  EgoState nan = pose(0, std::numeric_limits<double>::quiet_NaN(), 0, 0);
  ego.add(nan);
  ego.add(pose(0, 0, 0, 0));
  ego.add(pose(0, 0, 0, 0));
  ego.add(pose(1, 1e300, 0, 0));
  ego.add(pose(1, 0, -3e7, 0));
  EXPECT_EQ(ego.rejectedInvalid(), 4U);
  EXPECT_EQ(ego.rejectedOther(), 1U);
  EXPECT_EQ(ego.accepted(), 1U);
}

TEST(EgoPose, WithoutAnyPoseTheCallerParks) {
  const EgoPose ego;
  EXPECT_TRUE(ego.empty());
  EXPECT_FALSE(ego.at(kDriveStart));
  EXPECT_TRUE(EgoPose::parked(kDriveStart).T_world_ego.isApprox(Pose3::Identity()));
}

}  // namespace
}  // namespace perception
