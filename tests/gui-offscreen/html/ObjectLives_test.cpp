#include "gui-offscreen/html/ObjectLives.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

/// One object in three scenes, 0.1 s apart; sure from the second on.
std::vector<Scene> threeScenes() {
  std::vector<Scene> scenes;
  for (int k = 0; k < 3; ++k) {
    Scene scene;
    scene.stamp = Stamp::fromSeconds(1000) + 0.1 * k;
    SceneObject car;
    car.id = 7;
    car.classified = k > 0;
    car.class_probability = {0.9};
    car.position = Vector3(20, 0, 0);
    scene.objects = {car};
    scenes.push_back(scene);
  }
  return scenes;
}

TEST(ObjectLives, AStretchLastsToTheNextSceneAndTheLastSightIsAScene) {
  const std::vector<Scene> scenes = threeScenes();
  RunOutline run;
  run.first_stamp = scenes.front().stamp;
  for (const Scene& scene : scenes) run.stamps.push_back(scene.stamp);
  ObjectLives collected(run);
  for (const Scene& scene : scenes) collected.add(scene);
  const auto lives = collected.list();
  ASSERT_EQ(lives.size(), 1u);
  const ObjectLife& life = lives[0];
  ASSERT_EQ(life.stretches.size(), 2u);
  EXPECT_FALSE(life.stretches[0].sure);
  EXPECT_NEAR(life.stretches[0].to, 0.1, 1e-6);
  EXPECT_TRUE(life.stretches[1].sure);
  EXPECT_NEAR(life.to(), 0.3, 1e-6);
  EXPECT_NEAR(life.last_seen, 0.2, 1e-6);
}

}  // namespace
}  // namespace perception
