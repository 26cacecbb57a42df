#include "libperception/simulation/recorded/RecordedScene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace perception {
namespace {

constexpr double kSceneStep = 0.5;     // [s] between waypoints: annotations tremble
constexpr double kParked = 1;          // [m]
constexpr double kFastestObject = 55;  // [m/s] faster steps are faults of the annotation

std::optional<ObjectKind> kindOf(const std::string& type) {
  static const std::map<std::string, ObjectKind> kKinds = {
      {"Car", ObjectKind::kCar},         {"Van", ObjectKind::kVan},
      {"Truck", ObjectKind::kBus},       {"Bus", ObjectKind::kBus},
      {"Cyclist", ObjectKind::kCyclist}, {"Pedestrian", ObjectKind::kPedestrian}};
  const auto kind = kKinds.find(type);
  if (kind == kKinds.end()) return std::nullopt;
  return kind->second;
}

bool usable(const TruthObject& o) {
  return o.position.allFinite() && std::isfinite(o.yaw) && o.length > 0 && o.width > 0 &&
         o.height > 0 && kindOf(o.type);
}

void addWaypoint(WaypointParams& way, double t, const Vector2& place) {
  if (!way.t.empty()) {
    const double dt = t - way.t.back();
    const Vector2 last(way.x.back(), way.y.back());
    if (dt <= 0 || (place - last).norm() > kFastestObject * dt) return;
  }
  way.t.push_back(t), way.x.push_back(place.x()), way.y.push_back(place.y());
}

ObjectParams objectOf(const std::vector<const TruthObject*>& rows) {
  const TruthObject& first = *rows.front();
  ObjectParams object;
  object.name = fmt::format("truth_{}", first.id);
  object.kind = *kindOf(first.type);
  object.length = object.width = object.height = 0;
  const auto n = static_cast<double>(rows.size());
  double reach = 0;
  for (const TruthObject* o : rows) {
    object.length += o->length / n, object.width += o->width / n, object.height += o->height / n;
    reach = std::max(reach, (o->position - first.position).head<2>().norm());
  }
  constexpr double kMargin = 0.05;  // [s] scans are not quite at the instants of the truth
  object.from = first.t - kMargin, object.to = rows.back()->t + kMargin;
  WaypointParams& way = object.waypoints;
  way.heading = first.yaw;
  addWaypoint(way, first.t, first.position.head<2>());
  if (reach < kParked) return object;
  for (const TruthObject* o : rows)
    if (o->t - way.t.back() >= kSceneStep || o == rows.back())
      addWaypoint(way, o->t, o->position.head<2>());
  return object;
}

}  // namespace

Scenario recordedScene(const GroundTruth& truth, const std::vector<RecordedPose>& poses,
                       double duration) {
  Scenario scene;
  scene.params.duration = duration;
  scene.params.ground_roughness = 0;
  WaypointParams& way = scene.ego.waypoints;
  for (const RecordedPose& p : poses) {
    if (!way.t.empty() && p.t - way.t.back() < kSceneStep && &p != &poses.back()) continue;
    addWaypoint(way, p.t, p.T_world_ego.translation().head<2>());
  }
  if (way.t.empty()) addWaypoint(way, 0, Vector2::Zero());
  if (!poses.empty()) way.heading = yawOf(poses.front().T_world_ego);
  std::map<std::int64_t, std::vector<const TruthObject*>> by_id;
  for (const GroundTruth::Instant& instant : truth.instants)
    for (const TruthObject& o : instant.objects)
      if (usable(o)) by_id[o.id].push_back(&o);
  for (const auto& [id, rows] : by_id) scene.objects.push_back(objectOf(rows));
  return scene;
}

}  // namespace perception
