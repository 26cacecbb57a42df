#include "libperception/simulation/world/Scenario.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "libperception/core/Error.h"
#include "tests/simulation/SceneText.h"

namespace perception {
namespace {

using test::kCamera, test::kRoofLidar, test::kStanding, test::parked, test::scenarioOf;

std::string faultOf(const std::string& text) {
  try {
    scenarioOf(text);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(Scenario, KindGivesTheUsualSize) {
  const Scenario s = scenarioOf(kStanding + kRoofLidar + parked("bus", "bus", 20, 0) +
                                parked("van", "van", 20, 5, "length = 6"));
  ASSERT_EQ(s.objects.size(), 2u);
  EXPECT_EQ(s.objects[0].name, "bus");
  EXPECT_EQ(s.objects[0].length, 11);
  EXPECT_EQ(s.objects[1].length, 6);
  EXPECT_EQ(s.objects[1].width, 2.0);
}

TEST(Scenario, FourLayerLidarHasItsOwnDefaults) {
  const Scenario s = scenarioOf(kStanding + "[sensor.IBEO]\nkind = lidar4\nazimuth_to_deg = 40\n");
  EXPECT_NEAR(s.sensors[0].lidar.azimuth_from, radians(-55), 1e-12);
  EXPECT_NEAR(s.sensors[0].lidar.azimuth_to, radians(40), 1e-12);
  EXPECT_NEAR(s.sensors[0].lidar.azimuth_step, radians(0.25), 1e-12);
}

TEST(Scenario, FaultsAreConfigErrorsThatNameThePlace) {
  const std::string scene = kStanding + kRoofLidar;
  EXPECT_EQ(faultOf(scene), "");
  EXPECT_NE(faultOf(kStanding).find("at least one sensor"), std::string::npos);
  EXPECT_NE(faultOf(kRoofLidar).find("ego"), std::string::npos);
  EXPECT_NE(faultOf(scene + parked("a", "tram", 1, 1)).find("kind"), std::string::npos);
  EXPECT_NE(faultOf(scene + parked("a", "car", 1, 1, "lenght = 4")).find("lenght"),
            std::string::npos);
  EXPECT_NE(faultOf(scene + "[object.a]\nt = 0, 1\nx = 0, 1\ny = 0\n").find("as many"),
            std::string::npos);
  EXPECT_NE(faultOf(scene + "[object.a]\nt = 1, 0\nx = 0, 1\ny = 0, 0\n").find("increasing"),
            std::string::npos);
  EXPECT_NE(faultOf(scene + "[object.a]\n").find("waypoint"), std::string::npos);
  EXPECT_NE(
      faultOf(scene + "azimuth_from_deg = 10\nazimuth_to_deg = -10\n").find("azimuth_from_deg"),
      std::string::npos);
}

TEST(Scenario, SensorsTakeOnlyTheKeysOfTheirKind) {
  EXPECT_NE(faultOf(kStanding + kRoofLidar + "recall = 0.5\n").find("recall"), std::string::npos);
  EXPECT_NE(faultOf(kStanding + kCamera + "ring_step = 2\n").find("ring_step"), std::string::npos);
}

TEST(Scenario, EffectiveTextGivesTheSameScenario) {
  Config config = Config::fromText(kStanding + kRoofLidar + kCamera + parked("a", "bush", 5, 5));
  readScenario(config);
  const std::string text = config.effectiveText();
  Config again = Config::fromText(text);
  readScenario(again);
  EXPECT_NO_THROW(again.finish());
  EXPECT_EQ(again.effectiveText().substr(0, 200), text.substr(0, 200));
}

TEST(Scenario, ShippedScenariosAreSound) {
  int count = 0;
  const auto folder = std::filesystem::path(PERCEPTION_SOURCE_DIR) / "ini" / "scenarios";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".ini") continue;
    Config config = Config::fromFile(entry.path().string());
    readScenario(config);
    EXPECT_NO_THROW(config.finish()) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 2);
}

}  // namespace
}  // namespace perception
