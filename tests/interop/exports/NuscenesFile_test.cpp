#include "libperception/interop/exports/NuscenesFile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "libperception/core/Error.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

/// A car at frame 4, seen by lidar and radar, and a pole.
TrackedRun oneCar() {
  TrackedRun run;
  run.class_names = {"car", "static-other"};
  Scene scene;
  scene.frame = 4;
  SceneObject car;
  car.id = 7, car.existence = 0.8;
  car.class_probability = {1, 0};
  car.position = {10, 0, 0.2};
  car.length = 4, car.width = 2, car.height = 1.6;
  car.velocity = {3, 0};
  car.last_hit[Modality::kLidar] = Stamp{1};
  SceneObject pole = car;
  pole.id = 8;
  scene.objects = {car, pole};
  run.scenes = {scene};
  scene.frame = -1;  // between key frames
  scene.objects[0].existence = 0.6;
  run.scenes.push_back(scene);
  return run;
}

NuscenesSamples twoSamples() {
  NuscenesSamples samples;
  samples.tokens = {{4, "aa"}, {5, "bb"}};
  samples.T_global_world = makePose(100, 50, 0, M_PI / 2);
  return samples;
}

TEST(NuscenesFile, TracksAreBoxesOfTheGlobalFrameAtTheirSamples) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(writeNuscenesTracks(folder / "r.json", oneCar(), {{7, "car"}, {8, ""}}, twoSamples()),
            1U);
  std::ifstream file(folder / "r.json");
  const auto json = nlohmann::json::parse(file);
  EXPECT_TRUE(json.at("meta").at("use_lidar"));
  EXPECT_FALSE(json.at("meta").at("use_camera"));
  EXPECT_TRUE(json.at("results").at("bb").empty());
  ASSERT_EQ(json.at("results").at("aa").size(), 1U);
  const auto& box = json.at("results").at("aa").at(0);
  EXPECT_EQ(box.at("sample_token"), "aa");
  EXPECT_EQ(box.at("tracking_id"), "7");
  EXPECT_EQ(box.at("tracking_name"), "car");
  EXPECT_NEAR(box.at("tracking_score").get<double>(), 0.7, 1e-12) << "the track's mean";
  const double center[] = {100, 60, 1}, size[] = {2, 4, 1.6}, velocity[] = {0, 3};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(box.at("translation").at(i).get<double>(), center[i], 1e-9);
    EXPECT_NEAR(box.at("size").at(i).get<double>(), size[i], 1e-9);
  }
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_NEAR(box.at("velocity").at(i).get<double>(), velocity[i], 1e-9);
  EXPECT_NEAR(box.at("rotation").at(0).get<double>(), std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(box.at("rotation").at(3).get<double>(), std::sqrt(0.5), 1e-9);
}

TEST(NuscenesFile, SamplesComeBackAsTheyWereWritten) {
  const test::TemporaryFolder folder;
  const std::string path = samplesFileOf(folder / "drive.rawlog");
  EXPECT_EQ(path, folder / "drive.samples.csv");
  writeNuscenesSamples(path, twoSamples());
  const NuscenesSamples read = readNuscenesSamples(path);
  EXPECT_EQ(read.tokens, twoSamples().tokens);
  EXPECT_TRUE(read.T_global_world.isApprox(twoSamples().T_global_world, 1e-9));
  std::ofstream(path) << "frame,sample_token,x,y,z,qw,qx,qy,qz\n0,aa,0,0,0,2,0,0,0\n";
  EXPECT_THROW(readNuscenesSamples(path), DataError);
}

}  // namespace
}  // namespace perception
