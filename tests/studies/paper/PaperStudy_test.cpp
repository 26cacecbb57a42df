#include "studies/paper/PaperStudy.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

// The first second and a half of C: no object ahead yet, but every set must have run.
TEST(PaperStudy, RunsEverySensorSetOnOneSimulation) {
  PaperSite site;
  site.ini = PERCEPTION_SOURCE_DIR "/ini";
  site.seconds = 1.5;
  const PaperOutcome sun = runPaperEncounter(site, {"C", paperWeathers()[0], 1});
  ASSERT_EQ(sun.runs.size(), 6u);  // four sets, 1 and 4 particles
  for (const auto& [name, e] : sun.runs) EXPECT_GE(e.instants.size(), 12u) << name;
  ASSERT_EQ(sun.front_ends.count("Lidar"), 1u);
  EXPECT_GT(sun.front_ends.at("Lidar").measurements, 0u);
  EXPECT_EQ(sun.front_ends.count("Camera"), 1u);
}

TEST(PaperStudy, RainIsOfTheCameraAlone) {
  PaperSite site;
  site.ini = PERCEPTION_SOURCE_DIR "/ini";
  site.seconds = 1;
  const PaperOutcome rain = runPaperEncounter(site, {"A", paperWeathers().back(), 6});
  EXPECT_TRUE(rain.runs.empty());
  ASSERT_EQ(rain.front_ends.size(), 1u);
  EXPECT_EQ(rain.front_ends.begin()->first, "Camera");
  EXPECT_GT(rain.front_ends.begin()->second.scans, 3u);
}

}  // namespace
}  // namespace perception
