#include "libperception/core/Frames.h"

#include <gtest/gtest.h>

#include "libperception/core/Time.h"

namespace perception {
namespace {

TEST(Frames, PoseTurnsYawThenPitchThenRoll) {
  const Pose3 T = makePose(1, 2, 3, kPi / 2);
  EXPECT_TRUE((T * Vector3(1, 0, 0)).isApprox(Vector3(1, 3, 3)));
  // As in MRPT: a positive pitch lowers the nose, a positive roll lifts the left side.
  EXPECT_LT((makePose(0, 0, 0, 0, 0.1) * Vector3(1, 0, 0)).z(), 0);
  EXPECT_GT((makePose(0, 0, 0, 0, 0, 0.1) * Vector3(0, 1, 0)).z(), 0);
}

TEST(Frames, AnglesComeBackFromThePose) {
  for (double yaw = -3; yaw < 3.1; yaw += 0.7) {
    for (double pitch = -1.5; pitch < 1.55; pitch += 0.5) {
      for (double roll = -3; roll < 3.1; roll += 0.9) {
        const Pose3 T = makePose(0, 0, 0, yaw, pitch, roll);
        EXPECT_NEAR(yawOf(T), yaw, 1e-12);
        EXPECT_NEAR(pitchOf(T), pitch, 1e-12);
        EXPECT_NEAR(rollOf(T), roll, 1e-12);
      }
    }
  }
}

TEST(Frames, PlaneRotationIsThatOfThePose) {
  const Vector2 v = rotate2(0.7, {2, -1});
  EXPECT_TRUE((makePose(0, 0, 0, 0.7) * Vector3(2, -1, 0)).head<2>().isApprox(v));
}

TEST(Time, SecondsRoundToTheNearestNanosecond) {
  EXPECT_EQ(Stamp::fromSeconds(1.5e-9).ns, 2);
  EXPECT_EQ(Stamp::fromSeconds(-1.4e-9).ns, -1);
  EXPECT_EQ(Stamp::fromSeconds(-1.6e-9).ns, -2);
  EXPECT_DOUBLE_EQ(Stamp::fromSeconds(0.1).seconds(), 0.1);
}

TEST(Time, DifferencesAreExactWhereAbsoluteSecondsAreNot) {
  const Stamp today{1'317'052'000'123'456'789};  // KITTI's recordings are of September 2011
  EXPECT_DOUBLE_EQ((today + 1e-6) - today, 1e-6);
  EXPECT_DOUBLE_EQ(((today + 0.1) + 0.1) - today, 0.2);
  EXPECT_NEAR(today.seconds() - 1'317'052'000.123456789, 0, 2.5e-7);
}

TEST(Time, StampsAreOrdered) {
  const Stamp a{1}, b{2};
  EXPECT_TRUE(a < b && a <= b && a <= a && b > a && b >= a && a == a && a != b);
  EXPECT_FALSE(b < a || a > b || a == b || a != a || a >= b || b <= a);
}

}  // namespace
}  // namespace perception
