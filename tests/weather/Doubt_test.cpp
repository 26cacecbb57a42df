#include "libperception/weather/Doubt.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "libperception/weather/trust/PointTrust.h"

namespace perception {
namespace {

std::size_t of(const DoubtCounts& counts, DoubtCause cause) {
  return counts.returns[static_cast<std::size_t>(cause)];
}

TEST(Doubt, IsByTheLargestPartOfTheLogOdds) {
  OddsParts parts;
  parts[DoubtCause::kIsolated] = -1, parts[DoubtCause::kSensorLabel] = 1.25F;
  const Doubt doubt = parts.largest();
  EXPECT_EQ(doubt.cause, DoubtCause::kSensorLabel);
  EXPECT_EQ(doubt.evidence, 1.25);
  parts[DoubtCause::kIsolated] = 1.25F;
  EXPECT_EQ(parts.largest().cause, DoubtCause::kIsolated) << "of equal parts the first";
}

TEST(Doubt, CountsAddUpAndWhatIsRemovedIsGone) {
  DoubtCounts a, b;
  a.add({DoubtCause::kEcho, 2}), a.add({DoubtCause::kEcho, 0.5});
  b.add({DoubtCause::kMirror, 0});
  a += b;
  EXPECT_EQ(a.total(), 3U);
  EXPECT_EQ(a.evidence[static_cast<std::size_t>(DoubtCause::kEcho)], 2.5);
  a.remove({DoubtCause::kEcho, 0.5});
  EXPECT_EQ(of(a, DoubtCause::kEcho), 1U);
  EXPECT_EQ(of(a, DoubtCause::kMirror), 1U);
  EXPECT_EQ(a.evidence[static_cast<std::size_t>(DoubtCause::kEcho)], 2);
}

TEST(Doubt, NamesOfCausesDiffer) {
  const std::set<std::string> names(kDoubtCauseNames.begin(), kDoubtCauseNames.end());
  EXPECT_EQ(names.size(), kDoubtCauses);
  EXPECT_EQ(names.count(""), 0U);
}

/// A car's rear 10 m ahead of a lidar at 1.8 m, its image in the road, and one return in free air.
SensorFrame streetWithAReturnInTheAir() {
  SensorFrame frame;
  frame.T_ego_sensor = makePose(0, 0, 1.8, 0);
  frame.ground.measured = true;
  LidarCloud cloud;
  const auto add = [&cloud](double x, double y, double z) {
    cloud.x.push_back(static_cast<float>(x)), cloud.y.push_back(static_cast<float>(y));
    cloud.z.push_back(static_cast<float>(z));
  };
  add(5, 5, 0);
  for (int k = 0; k < 40; ++k) {
    const double y = -0.8 + 0.04 * k;
    add(10, y, -2.5 - 0.02 * k), add(10, y, -1.1 + 0.02 * k), add(6, y, -1.8);
  }
  frame.data = std::move(cloud);
  return frame;
}

LidarCloud& cloudOf(SensorFrame& frame) { return std::get<LidarCloud>(frame.data); }

WeatherParams withoutMemory() {
  WeatherParams params;
  params.filter = "trust";
  params.trust.adapt_share = params.trust.use_intensity = false;
  return params;
}

TEST(Doubt, AReturnAloneInTheAirIsIsolated) {
  SensorFrame frame = streetWithAReturnInTheAir();
  const auto filter = makePointFilter(withoutMemory());
  filter->apply(frame);
  ASSERT_LT(cloudOf(frame).trust[0], 0.5F);
  const auto doubt = filter->doubtAbout(0);
  ASSERT_TRUE(doubt);
  EXPECT_EQ(doubt->cause, DoubtCause::kIsolated);
  EXPECT_GT(doubt->evidence, 0);
}

TEST(Doubt, TheSensorsLabelIsTheCauseWhereItWeighsMore) {
  SensorFrame frame = streetWithAReturnInTheAir();
  cloudOf(frame).label.assign(cloudOf(frame).size(),
                              static_cast<std::uint8_t>(PointLabel::kObject));
  cloudOf(frame).label[0] = static_cast<std::uint8_t>(PointLabel::kDirt);
  WeatherParams params = withoutMemory();
  params.trust.sensor_label = 40;
  const auto filter = makePointFilter(params);
  const TrustStats stats = filter->apply(frame);
  ASSERT_TRUE(filter->doubtAbout(0));
  EXPECT_EQ(filter->doubtAbout(0)->cause, DoubtCause::kSensorLabel);
  EXPECT_NEAR(filter->doubtAbout(0)->evidence, 40 * params.trust.gain, 1e-4);
  EXPECT_EQ(of(stats.doubts, DoubtCause::kSensorLabel), 1U);
}

TEST(Doubt, TheFirstOfTwoEchoesIsTheCauseWhereItWeighsMore) {
  SensorFrame frame = streetWithAReturnInTheAir();
  LidarCloud& cloud = cloudOf(frame);
  cloud.x.insert(cloud.x.begin() + 1, 15), cloud.y.insert(cloud.y.begin() + 1, 15);
  cloud.z.insert(cloud.z.begin() + 1, 0);
  cloud.intensity.assign(cloud.size(), 0.3F), cloud.echo.assign(cloud.size(), 0);
  cloud.echo[1] = 1, cloud.intensity[1] = 0.5F;
  WeatherParams params = withoutMemory();
  params.trust.rain_rule = 40;
  const auto filter = makePointFilter(params);
  filter->apply(frame);
  ASSERT_TRUE(filter->doubtAbout(0));
  EXPECT_EQ(filter->doubtAbout(0)->cause, DoubtCause::kEcho);
}

TEST(Doubt, EveryDoubtedReturnHasOneCauseAndMirrorImagesHaveTheirs) {
  SensorFrame frame = streetWithAReturnInTheAir();
  const auto filter = makePointFilter(withoutMemory());
  const TrustStats stats = filter->apply(frame);
  const LidarCloud& cloud = cloudOf(frame);
  EXPECT_GE(of(stats.doubts, DoubtCause::kMirror), 30U);
  EXPECT_EQ(of(stats.doubts, DoubtCause::kMirror), stats.mirrored);
  EXPECT_EQ(stats.doubts.total(), stats.phantoms);
  DoubtCounts counted;
  double lost = 0;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    lost += static_cast<double>(1 - cloud.trust[i]);
    const auto doubt = filter->doubtAbout(i);
    EXPECT_EQ(doubt.has_value(), cloud.trust[i] < 0.5F) << i;
    if (doubt) counted.add(*doubt);
  }
  EXPECT_EQ(counted.returns, stats.doubts.returns);
  EXPECT_NEAR(stats.weight_lost, lost, 1e-2);
}

TEST(Doubt, TheLargestPartIsAtLeastAFifthOfTheLogOddsOfTheTrust) {
  SensorFrame frame = streetWithAReturnInTheAir();
  PointTrust trust(withoutMemory().trust);
  trust.apply(frame);
  std::size_t doubted = 0;
  for (const SuspectReturn& s : trust.suspects()) {
    const auto doubt = trust.doubtAbout(s.index);
    if (!doubt) continue;
    ++doubted;
    const double t = static_cast<double>(cloudOf(frame).trust[s.index]);
    EXPECT_GE(5 * doubt->evidence, std::log((1 - t) / t) - 1e-3) << "the largest of five";
  }
  EXPECT_GT(doubted, 0U);
}

TEST(Doubt, OtherFramesAndUnknownReturnsHaveNone) {
  PointTrust trust({});
  SensorFrame radar;
  radar.data = RadarReturns{};
  trust.apply(radar);
  EXPECT_FALSE(trust.doubtAbout(0));
  SensorFrame frame = streetWithAReturnInTheAir();
  trust.apply(frame);
  EXPECT_FALSE(trust.doubtAbout(1'000'000));
}

}  // namespace
}  // namespace perception
