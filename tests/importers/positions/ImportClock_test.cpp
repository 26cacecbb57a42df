#include "libperception/importers/positions/ImportClock.h"

#include <gtest/gtest.h>

#include <cmath>

namespace perception {
namespace {

constexpr std::int64_t kTenth = 100'000'000;  // [ns]

std::vector<GpsFix> fixesAt(const std::vector<std::int64_t>& tenths) {
  std::vector<GpsFix> fixes;
  for (const auto t : tenths) fixes.push_back({Stamp{t * kTenth}, 0, 0, 0});
  return fixes;
}

std::vector<std::int64_t> tenthsOf(const std::vector<GpsFix>& fixes) {
  std::vector<std::int64_t> out;
  for (const auto& f : fixes) out.push_back(f.stamp.ns / kTenth);
  return out;
}

TEST(SteadyFixes, KeepsWhatGoesForward) {
  std::size_t dropped = 0;
  const std::vector<std::int64_t> times{10, 11, 12,
                                        13, 50, 51};  // a lost fix is no fault of the clock
  EXPECT_EQ(tenthsOf(steadyFixes(fixesAt(times), dropped)), times);
  EXPECT_EQ(dropped, 0u);
}

TEST(SteadyFixes, FixesToldTwiceAreOne) {
  std::size_t dropped = 0;
  EXPECT_EQ(steadyFixes(fixesAt({10, 10, 11, 11, 12}), dropped).size(), 3u);
  EXPECT_EQ(dropped, 0u);
}

TEST(SteadyFixes, WhatIsStampedByAClockSetBackGoes) {
  std::size_t dropped = 0;
  // Set back by 0.4 s after 1.3, forward again before 1.9; 1.4 and 1.5 lie after 1.3 and are wrong
  // all the same.
  const auto kept = steadyFixes(fixesAt({10, 11, 12, 13, 10, 11, 12, 13, 14, 15, 19, 20}), dropped);
  EXPECT_EQ(tenthsOf(kept), (std::vector<std::int64_t>{10, 11, 12, 13, 19, 20}));
  EXPECT_EQ(dropped, 6u);
}

TEST(PoseBetween, IsEmptyOutsideThePoses) {
  const std::vector<StampedPose> poses{{Stamp{0}, makePose(0, 0, 0, 0)},
                                       {Stamp{1'000'000'000}, makePose(4, 0, 0, 1)}};
  EXPECT_FALSE(poseBetween(poses, Stamp{-1}));
  EXPECT_FALSE(poseBetween(poses, Stamp{1'000'000'001}));
  const auto half = poseBetween(poses, Stamp{500'000'000});
  ASSERT_TRUE(half);
  EXPECT_TRUE(half->isApprox(makePose(2, 0, 0, 0.5), 1e-9));
  EXPECT_TRUE(poseBetween(poses, Stamp{0}));
}

/// A vehicle that brakes from 12 m/s on a bend, between walls with pillars; scans at 10 Hz, poses
/// at 20 Hz whose clock is `shift` behind.
struct Drive {
  static Pose3 at(double t) { return makePose(12 * t - t * t, 0.4 * t * t, 0, 0.08 * t); }
  std::vector<StampedPose> poses(double shift) const {
    std::vector<StampedPose> out;
    for (double t = -3; t <= 7; t += 0.05)
      out.push_back({Stamp::fromSeconds(100 + t - shift), at(t)});
    return out;
  }
  std::vector<StampedScan> scans() const {
    std::vector<StampedScan> out;
    for (int k = 0; k < 40; ++k) {
      const double t = 0.1 * k;
      const Pose3 T_ego_world = at(t).inverse();
      StampedScan scan{Stamp::fromSeconds(100 + t), {}};
      for (int post = -10; post < 40; ++post) {
        for (int i = 0; i < 8; ++i) {
          const Vector3 p(3.0 * post + 0.05 * (post * post % 7), post % 2 ? 8 : -6, 1 + 0.1 * i);
          scan.second.push_back(T_ego_world * p);
        }
      }
      out.push_back(std::move(scan));
    }
    return out;
  }
};

TEST(ClockShift, IsFoundByTheScans) {
  const Drive drive;
  for (const double shift : {-1.0, 0.0, 1.54}) {
    const auto found = clockShift(drive.poses(shift), drive.scans(), 0.3);
    ASSERT_TRUE(found) << shift;
    EXPECT_NEAR(*found, shift, 0.05);
  }
}

TEST(ClockShift, IsNotGuessed) {
  const Drive drive;
  EXPECT_FALSE(clockShift(drive.poses(0), {}, 0));
  EXPECT_FALSE(clockShift({}, drive.scans(), 0));
  // Beyond what the poses cover: the best that can be looked at lies at the end.
  EXPECT_FALSE(clockShift(drive.poses(1), drive.scans(), 0, 0.5));
}

}  // namespace
}  // namespace perception
