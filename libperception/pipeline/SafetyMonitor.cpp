#include "libperception/pipeline/SafetyMonitor.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

constexpr double kMirrored = -0.3;  // [m] lower returns are mirror images in a wet road
constexpr double kLeaves = 0.5;     // [s] for which a cell belongs to what has left it; assumed
/// [-] x / |y| in the ego frame below which a return lies behind the vehicle (bearings beyond 117
/// deg): it is ahead only after a turn, during which it is seen anew; assumed.
constexpr float kBehind = -0.5f;
constexpr float kDoubted = 0.5F;  // of a return: more likely a phantom than not
constexpr double kFresh = 0.5;    // [s] after which a scan says nothing of the way ahead; assumed

// The vehicle on the ground plane: z = 0 is the ground.
Pose3 groundPose(const Pose3& T_world_ego, const GroundPlane& plane) {
  return T_world_ego * makePose(0, 0, plane.c, 0, -std::atan(plane.a), std::atan(plane.b));
}

/// Whether of the obstacle returns in the corridor, up to the obstacle and half a meter into it,
/// more are doubted than not.
bool inCloud(const Corridor& corridor, const GridScan& scan, double obstacle) {
  constexpr double kInto = 0.5;  // [m]
  const Pose3 T_ego_world = corridor.T_world_ego.inverse();
  std::size_t doubted = 0, trusted = 0;
  for (std::size_t i = 0; i < scan.weights.size(); ++i) {
    const Vector3 p = T_ego_world * scan.hits[i];
    const ArcPlace place = arcPlace(corridor, p.x(), p.y());
    if (std::abs(place.d) > corridor.width / 2) continue;
    if (place.s < corridor.from || place.s > obstacle + kInto) continue;
    ++(scan.weights[i] < kDoubted ? doubted : trusted);
  }
  return doubted > trusted;
}

// Within the outline, or where it was up to half a second ago: cells that it left are cleared only
// by the beams that pass later.
bool owns(const SceneObject& object, const Vector3& place, double grow) {
  const Vector2 p = rotate2(-object.yaw, place.head<2>() - Vector2(object.position.head<2>()));
  const double left = kLeaves * object.speed;
  const double rear = object.length / 2 + grow + std::max(left, 0.0);
  const double front = object.length / 2 + grow + std::max(-left, 0.0);
  return p.x() >= -rear && p.x() <= front && std::abs(p.y()) <= object.width / 2 + grow;
}

// The most certain object that covers the place; null: none.
const SceneObject* ownerOf(const Scene& scene, const Vector3& place, double grow) {
  const SceneObject* owner = nullptr;
  for (const SceneObject& object : scene.objects) {
    if (!owns(object, place, grow)) continue;
    if (owner == nullptr || object.existence > owner->existence) owner = &object;
  }
  return owner;
}

}  // namespace

ObstacleScan obstacleScanOf(const SensorFrame& frame, const PlacedReturns& returns) {
  ObstacleScan obstacles;
  GridScan& scan = obstacles.scan;
  scan.stamp = frame.stamp;
  scan.origin = frame.T_world_sensor().translation();
  scan.T_world_ground = groundPose(frame.ego.T_world_ego, frame.ground);
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  const bool weighted = cloud != nullptr && !cloud->trust.empty();
  scan.clear.reserve(returns.size());
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const double height = static_cast<double>(returns.height[i]);
    if (height <= kMirrored || returns.x[i] < kBehind * std::abs(returns.y[i])) continue;
    const Vector3 place = frame.ego.T_world_ego * Vector3(static_cast<double>(returns.x[i]),
                                                          static_cast<double>(returns.y[i]),
                                                          static_cast<double>(returns.z[i]));
    const bool hit = height > returns.height_min && height < returns.height_max;
    (hit ? scan.hits : scan.clear).push_back(place);
    if (!hit) continue;
    const float trust = weighted ? cloud->trust[returns.source[i]] : 1;
    const float phantom = returns.phantom.empty() ? 0 : returns.phantom[i];
    const bool alone = phantom == PlacedReturns::kNoCluster;
    const float weight = alone ? trust : trust * (1 - phantom);
    if (weighted) scan.weights.push_back(weight);
    obstacles.clustered.push_back(alone || weight < kDoubted ? 0 : weight);
  }
  return obstacles;
}

SafetyMonitor::SafetyMonitor(const GridParams& grid, const StopParams& stop)
    : params_(grid), stop_(stop), grid_(makeSafetyGrid(grid)) {}

void SafetyMonitor::add(const SensorFrame& frame, const PlacedReturns& returns) {
  last_ = obstacleScanOf(frame, returns);
  grid_->insert(last_.scan);
  front_ = returns.vehicle_front;
  any_ = true;
}

PathAhead SafetyMonitor::pathAhead(const EgoState& ego) const {
  PathAhead path;
  path.known = any_ && std::abs(ego.stamp - last_.scan.stamp) <= kFresh;
  if (!path.known) return path;
  path.corridor = drivenCorridor(ego.T_world_ego, ego.velocity.norm(), ego.yaw_rate, front_, stop_);
  path.free = grid_->freeDistance(path.corridor);
  path.corridor.max = path.free.distance;
  const FreeDistance dense =
      denseReturns(path.corridor, last_.scan.hits, last_.clustered, stop_.returns);
  path.corridor.max = stop_.look_ahead;
  if (dense.blocked) {
    path.free.distance = dense.distance;
    path.free.blocked = true;
    path.free.place = dense.place;
    path.free.seen = std::min(path.free.seen, dense.distance);
  }
  path.in_cloud = path.free.blocked && inCloud(path.corridor, last_.scan, path.free.distance);
  return path;
}

FreePath SafetyMonitor::advise(const PathAhead& path, const Scene& scene) {
  FreePath advice;
  advice.distance = path.free.distance;
  advice.seen = path.free.seen;
  advice.blocked = path.free.blocked;
  const bool before = near_ && scene.stamp - *near_ <= kFresh;
  near_.reset();
  if (!advice.blocked) return advice;
  const SceneObject* owner = ownerOf(scene, path.free.place, stop_.obstacle_grow);
  const double speed = scene.ego.velocity.norm();
  const Vector2 ahead = scene.ego.T_world_ego.linear().col(0).head<2>();
  const double along = owner == nullptr ? 0 : owner->velocity.dot(ahead);
  advice.owner = owner == nullptr ? 0 : owner->id;
  const bool near = path.free.distance - path.corridor.from < stoppingDistance(speed, along, stop_);
  if (near) near_ = scene.stamp;
  advice.stop = near && (before || !path.in_cloud);
  return advice;
}

void SafetyMonitor::restart() {
  grid_ = makeSafetyGrid(params_);
  any_ = false;
  near_.reset();
}

}  // namespace perception
