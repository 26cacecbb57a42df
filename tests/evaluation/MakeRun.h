#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception::testing_evaluation {

/// Places of the classes in the runs of makeRun().
inline constexpr ClassId kPedestrian = 0, kCar = 1, kStaticOther = 2;

/// A run without scenes at the log time 0.
inline TrackedRun makeRun() {
  TrackedRun run;
  run.dir = "run";
  run.first_stamp = Stamp::fromSeconds(1000);
  run.class_names = {"pedestrian", "car", "static-other"};
  return run;
}

/// A classified car of no size at (x, y) [m], world.
inline SceneObject makeObject(std::uint64_t id, double x, double y, ClassId class_id = kCar,
                              double probability = 0.98) {
  SceneObject object;
  object.id = id;
  object.class_id = class_id;
  object.classified = probability >= .95;
  object.class_probability.assign(3, (1 - probability) / 2);
  object.class_probability[static_cast<std::size_t>(class_id)] = probability;
  object.existence = .9;
  object.position = {x, y, 0};
  object.has_yaw = true;
  object.last_hit[Modality::kLidar] = Stamp::fromSeconds(1000);
  return object;
}

/// The vehicle at the origin looking along x; frame k is at k / 10 [s].
inline Scene makeScene(std::int64_t frame, std::vector<SceneObject> objects = {}) {
  Scene scene;
  scene.frame = frame;
  scene.stamp = Stamp::fromSeconds(1000 + 0.1 * static_cast<double>(frame));
  scene.objects = std::move(objects);
  return scene;
}

/// A car of no size at (x, y) [m], world, with 50 lidar points.
inline TruthObject makeTruth(std::int64_t frame, std::int64_t id, double x, double y,
                             const std::string& type = "Car") {
  TruthObject object;
  object.frame = frame;
  object.t = 0.1 * static_cast<double>(frame);
  object.id = id;
  object.type = type;
  object.position = {x, y, 0};
  object.lidar_points = 50;
  return object;
}

/// The truth of these lines, by time.
inline GroundTruth makeGroundTruth(const std::vector<TruthObject>& objects) {
  std::map<double, GroundTruth::Instant> instants;
  for (const TruthObject& object : objects) {
    GroundTruth::Instant& instant = instants[object.t];
    instant.frame = object.frame;
    instant.t = object.t;
    instant.objects.push_back(object);
  }
  GroundTruth truth;
  for (auto& [t, instant] : instants) truth.instants.push_back(std::move(instant));
  return truth;
}

}  // namespace perception::testing_evaluation
