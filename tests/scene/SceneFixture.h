#pragma once
#include <fstream>
#include <sstream>
#include <string>

#include "libperception/measurement/objects/ObjectClass.h"
#include "libperception/scene/Scene.h"
#include "tests/support/TemporaryFolder.h"

namespace perception::test {

inline std::string readText(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

inline void writeText(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

inline ClassTable pedestrianAndCar() {
  ClassTable table;
  table.classes.resize(2);
  table.classes[0].name = "pedestrian";
  table.classes[0].kitti_type = "Pedestrian";
  table.classes[1].name = "car";
  table.classes[1].kitti_type = "Car";
  return table;
}

inline constexpr Stamp kFirstStamp{1700000000123456789};

inline SceneObject someCar(std::uint64_t id = 1) {
  SceneObject o;
  o.id = id;
  o.class_id = 1;
  o.classified = true;
  o.class_probability = {0.0123, 0.9877};
  o.existence = 0.987654;
  o.position = {12.3456, -7.0001, 0.25};
  o.yaw = -3.141592;
  o.has_yaw = true;
  o.p_front = 0.875;
  o.velocity = {-5.5, 0.125};
  o.speed = -5.5014;
  o.length = 4.5, o.width = 1.8, o.height = 1.5;
  o.sd_x = 0.1, o.sd_y = 0.2, o.sd_yaw = 0.03, o.sd_speed = 0.4;
  o.last_hit[Modality::kLidar] = Stamp{kFirstStamp.ns + 1};
  return o;
}

inline Scene someScene(std::int64_t frame, std::vector<SceneObject> objects) {
  Scene scene;
  scene.frame = frame;
  scene.stamp = Stamp{kFirstStamp.ns + frame * 103519669};  // 9.66 Hz
  scene.ego.stamp = scene.stamp;
  scene.ego.T_world_ego = makePose(100.5, -3.25, 0.125, 2.5, 0.01, -0.02);
  scene.ego.velocity = {3, 4};
  scene.ego.yaw_rate = 0.1;
  scene.objects = std::move(objects);
  return scene;
}

}  // namespace perception::test
