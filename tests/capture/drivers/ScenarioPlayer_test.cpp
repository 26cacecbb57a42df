#include "libperception/capture/drivers/ScenarioPlayer.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationComment.h>

#include "libperception/config/Config.h"
#include "libperception/core/Error.h"
#include "libperception/simulation/world/Scenario.h"

namespace perception {
namespace {

// Half a minute ahead of the clock: nothing is due by itself.
const ScenarioSource kDemo{PERCEPTION_SOURCE_DIR "/ini/scenarios/demo.ini", 5, 30};

TEST(ScenarioPlayer, GivesEachSensorWhatTheSimulatorGives) {
  Config config = Config::fromFile(kDemo.scenario);
  Simulator simulator(readScenario(config), "demo", kDemo.seed);
  ScenarioPlayer player(kDemo);
  std::map<std::string, std::vector<double>> expected;
  const double first = 1577836800;
  while (const auto o = simulator.next()) {
    const double t = mrpt::Clock::toDouble(o->timestamp) - first;
    if (t > 1.5) break;
    expected[player.has(o->sensorLabel) ? o->sensorLabel : ScenarioPlayer::kVehicle].push_back(t);
  }
  ASSERT_EQ(expected.size(), 3U);
  for (const auto& [label, times] : expected) {
    // In two bites.
    auto taken = player.takeUntil(label, 0.7);
    const std::size_t before = taken.size();
    const auto rest = player.takeUntil(label, 1.5);
    taken.insert(taken.end(), rest.begin(), rest.end());
    EXPECT_GT(before, 0U) << label;
    ASSERT_EQ(taken.size(), times.size()) << label;
    for (std::size_t i = 1; i < times.size(); ++i) {
      const double gap =
          mrpt::Clock::toDouble(taken[i]->timestamp) - mrpt::Clock::toDouble(taken[0]->timestamp);
      EXPECT_NEAR(gap, times[i] - times[0], 2e-6) << label;
    }
  }
  EXPECT_FALSE(player.ended());
}

TEST(ScenarioPlayer, FirstEntryCallsTheLogSimulated) {
  ScenarioPlayer player(kDemo);
  const auto first = player.takeUntil(ScenarioPlayer::kVehicle, 0);
  ASSERT_FALSE(first.empty());
  const auto comment = std::dynamic_pointer_cast<mrpt::obs::CObservationComment>(first[0]);
  ASSERT_TRUE(comment);
  EXPECT_EQ(comment->text.rfind(kSimulatedText, 0), 0U);
}

TEST(ScenarioPlayer, EndsOnceAllWasTaken) {
  ScenarioPlayer player(kDemo);
  for (const std::string& label : player.labels()) {
    EXPECT_FALSE(player.ended());
    player.takeUntil(label, 1e3);
  }
  EXPECT_TRUE(player.ended());
  EXPECT_TRUE(player.takeUntil("LIDAR_TOP", 2e3).empty());
}

TEST(ScenarioPlayer, IsSharedBySource) {
  const auto one = ScenarioPlayer::shared(kDemo);
  EXPECT_EQ(one, ScenarioPlayer::shared(kDemo));
  ScenarioSource other = kDemo;
  other.seed = 6;
  EXPECT_NE(one, ScenarioPlayer::shared(other));
}

TEST(ScenarioPlayer, NothingIsDueBeforeTheStart) {
  ScenarioPlayer player(kDemo);
  EXPECT_TRUE(player.take("LIDAR_TOP").empty());
}

TEST(ScenarioPlayer, MissingScenarioIsAConfigError) {
  EXPECT_THROW(ScenarioPlayer({"/nonexistent/scenario.ini", 1, 0}), ConfigError);
}

}  // namespace
}  // namespace perception
