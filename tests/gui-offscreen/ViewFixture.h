#pragma once
#include "gui-offscreen/views/Snapshot.h"
#include "tests/gui-offscreen/PictureColors.h"

namespace perception::test {

/// The one renderer of the test program (see Renderer), for all its tests.
inline Snapshot& snapshot() {
  static Snapshot instance([] {
    SnapshotParams params;
    params.views = {ViewKind::kTop, ViewKind::kDriver};
    return params;
  }());
  return instance;
}

/// An object of the world, seen by a vehicle at (100, 50) that looks along +y.
inline SceneObject objectAt(std::uint64_t id, ClassId class_id, double x, double y) {
  SceneObject object;
  object.id = id;
  object.class_id = class_id;
  object.class_probability = {0.05, 0.95};
  object.existence = 0.99;
  object.position = Vector3(x, y, 0);
  object.length = 4;
  object.width = 2;
  object.height = 1.5;
  object.has_yaw = true;
  return object;
}

inline SceneView emptyView() {
  SceneView view;
  view.run_name = "test";
  view.class_names = {"pedestrian", "car"};
  view.scene.frame = 7;
  view.scene.ego.T_world_ego = makePose(100, 50, 0, kPi / 2);
  return view;
}

}  // namespace perception::test
