// On real snow, clear air and simulated snow; trust_study prints the tables.
#include <gtest/gtest.h>

#include "libperception/weather/trust/PointTrust.h"
#include "tests/support/LabeledScans.h"

namespace perception {
namespace {

using test::PhantomScore;

std::string data(const std::string& set) {
  return std::string(PERCEPTION_SHARED_DATA) + "/data/" + set;
}

/// Flat ground at the mounting height: the study measures it.
PhantomScore scoreOf(std::vector<test::LabeledScan> scans, std::uint32_t phantom,
                     const TrustParams& params) {
  const auto trust = makePointTrust(params);
  PhantomScore score;
  for (auto& scan : scans) {
    trust->apply(scan.frame);
    if (phantom == test::kSnowLabel && scan.number % 2 == 1) continue;  // fitted to
    score.add(scan, std::get<LidarCloud>(scan.frame.data).trust, phantom);
  }
  return score;
}

TEST(PointTrustOnWads, TellsRealSnowAndKeepsCarsAndPersons) {
  const auto scans = test::labeledScans(data("wads_snow"), 2.17, 8);
  if (scans.empty()) GTEST_SKIP() << "no wads_snow";
  const PhantomScore score = scoreOf(scans, test::kSnowLabel, {});
  EXPECT_GT(score.f1(), 0.96);
  EXPECT_LT(score.lost(), 0.005);
}

TEST(PointTrustOnWads, TellsRealSnowWithoutIntensity) {
  auto scans = test::labeledScans(data("wads_snow"), 2.17, 8);
  if (scans.empty()) GTEST_SKIP() << "no wads_snow";
  TrustParams params;
  params.use_intensity = false;
  const PhantomScore score = scoreOf(scans, test::kSnowLabel, params);
  EXPECT_GT(score.f1(), 0.92);
  EXPECT_LT(score.lost(), 0.005);
}

TEST(PointTrustOnSnowyKitti, TellsSimulatedSnowWithTheSameParameters) {
  const auto scans = test::labeledScans(data("snowykitti"), 1.73);
  if (scans.empty()) GTEST_SKIP() << "no snowykitti";
  EXPECT_GT(scoreOf(scans, 1, {}).f1(), 0.90);
}

TEST(PointTrustOnKitti, DoubtsHardlyAReturnInClearAir) {
  auto scans = test::labeledScans(data("kitti_lidar_seq0000"), 1.73, 1000, "velodyne_full");
  if (scans.empty()) GTEST_SKIP() << "no kitti_lidar_seq0000";
  const auto trust = makePointTrust({});
  std::size_t returns = 0, doubted = 0;
  for (auto& scan : scans) {
    const TrustStats stats = trust->apply(scan.frame);
    returns += stats.returns, doubted += stats.phantoms;
  }
  EXPECT_LT(static_cast<double>(doubted), 5e-4 * static_cast<double>(returns));
}

}  // namespace
}  // namespace perception
