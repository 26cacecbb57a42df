#include "libperception/pipeline/safety/SafetyMonitor.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "libperception/grid/way/NearCorridor.h"
#include "libperception/pipeline/safety/Clearance.h"

namespace perception {
namespace {

constexpr double kLeaves = 0.5;     // [s] for which a cell belongs to what has left it; assumed
constexpr double kCarHeight = 1.7;  // [m] of a vehicle whose height is not given; assumed
constexpr double kFresh = 0.5;      // [s] after which a scan says nothing of the way ahead; assumed
/// A surface of so many times `stop.returns` returns in one scan is not one by chance; assumed.
constexpr double kSolidAtOnce = 2;

/// Whether most of the obstacle returns in the corridor, up to the obstacle and half a meter into
/// it, are doubted. Not where `solid` or more returns of that half meter are of a solid surface.
bool inCloud(const Corridor& corridor, const ObstacleScan& obstacles, double obstacle,
             double solid) {
  constexpr double kInto = 0.5;  // [m]
  const GridScan& scan = obstacles.scan;
  if (scan.weights.size() != scan.hits.size()) return false;
  const Pose3 T_ego_world = corridor.T_world_ego.inverse();
  std::size_t doubted = 0, trusted = 0, walls = 0;
  for (const std::uint32_t i : nearCorridor(corridor, obstacle + kInto, scan.hits)) {
    const Vector3 p = T_ego_world * scan.hits[i];
    const auto place = arcPlaceWithin(corridor, p.x(), p.y(), corridor.width / 2);
    if (!place || place->s < corridor.from || place->s > obstacle + kInto) continue;
    ++(scan.weights[i] < kDoubted ? doubted : trusted);
    walls += !obstacles.solid.empty() && obstacles.solid[i] && place->s >= obstacle;
  }
  return doubted > trusted && static_cast<double>(walls) < solid;
}

void trustHit(ObstacleScan& obstacles, std::size_t hit) {
  obstacles.dense[hit] = 1;
  if (!obstacles.scan.weights.empty()) obstacles.scan.weights[hit] = 1;
}

/// Counts the returns that speak for the obstacle of a path.
void countReturns(const ObstacleScan& scan, PathAhead& path) {
  constexpr double kBefore = 0.2;  // [m] a cell begins before its returns
  constexpr double kInto = 0.5;    // [m]
  const Pose3 T_ego_world = path.corridor.T_world_ego.inverse();
  const double end = path.free.distance + kInto;
  for (const std::uint32_t k : nearCorridor(path.corridor, end, scan.scan.hits)) {
    const Vector3 p = T_ego_world * scan.scan.hits[k];
    const auto place = arcPlaceWithin(path.corridor, p.x(), p.y(), path.corridor.width / 2);
    if (!place) continue;
    const double into = place->s - path.free.distance;
    if (into < -kBefore || into > kInto) continue;
    const bool counts = scan.scan.weights.empty() || scan.scan.weights[k] >= kDoubted;
    path.returns += counts, path.overruled += counts && scan.doubted[k];
  }
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

SafetyMonitor::SafetyMonitor(const GridParams& grid, const StopParams& stop, TrustParams trust)
    : params_(grid), stop_(stop), trust_(std::move(trust)), grid_(makeSafetyGrid(grid)) {}

void SafetyMonitor::add(const SensorFrame& frame, const PlacedReturns& returns) {
  const Vector3 sensor = frame.T_ego_sensor.translation();
  const double ground = frame.ground.a * sensor.x() + frame.ground.b * sensor.y() + frame.ground.c;
  highest_ = std::max({highest_, sensor.z() - ground, kCarHeight});
  const double clearance = vehicleHeight() + stop_.clearance;
  last_ = obstacleScanOf(frame, returns, trust_, stop_, clearance);
  const bool in_space = params_.back_end == GridParams::BackEnd::kRolling ||
                        params_.back_end == GridParams::BackEnd::kOctomap;
  if (in_space) clearOverhead(frame, returns, clearance, params_.resolution, last_.scan);
  trustWhatPersists();
  grid_->insert(last_.scan);
  Corridor way = drivenCorridor(frame.ego.T_world_ego, frame.ego.velocity, frame.ego.yaw_rate,
                                returns.vehicle_front, returns.vehicle_rear, stop_);
  std::vector<float> unseen;
  way.road = last_.road.along(way, &unseen);
  way_.add(frame.stamp, std::move(way), unseen, last_.scan.hits, last_.dense, last_.scan.clear,
           frame.causes);
  front_ = returns.vehicle_front, rear_ = returns.vehicle_rear;
  any_ = true;
}

// The doubt about a surface ends where it is seen in the second scan.
void SafetyMonitor::trustWhatPersists() {
  std::vector<Vector3> surfaces;
  std::vector<std::size_t> hits;
  for (std::size_t k = 0; k < last_.surface.size(); ++k)
    if (last_.surface[k]) surfaces.push_back(last_.scan.hits[k]), hits.push_back(k);
  const std::vector<char> again = places_.add(surfaces);
  for (std::size_t j = 0; j < hits.size(); ++j)
    if (again[j]) trustHit(last_, hits[j]);
}

double SafetyMonitor::vehicleHeight() const {
  return stop_.vehicle.height > 0 ? stop_.vehicle.height : highest_;
}

PathAhead SafetyMonitor::pathAhead(const EgoState& ego) const {
  PathAhead path;
  path.known = any_ && std::abs(ego.stamp - last_.scan.stamp) <= kFresh;
  if (!path.known) return path;
  path.corridor = drivenCorridor(ego.T_world_ego, ego.velocity, ego.yaw_rate, front_, rear_, stop_);
  path.corridor.road = last_.road.along(path.corridor);
  const double look_ahead = path.corridor.max;
  path.free = grid_->freeDistance(path.corridor);
  path.corridor.max = path.free.distance;
  const double near =
      path.corridor.from + stoppingDistance(ego.velocity.norm(), 0, stop_) + stop_.margin;
  const ReturnObstacle found = way_.nearest(path.corridor, near, stop_.returns);
  if (found.free.blocked) {
    path.by_returns =
        !path.free.blocked || found.free.distance < path.free.distance - params_.resolution;
    path.free.distance = found.free.distance;
    path.free.blocked = true;
    path.free.place = found.free.place;
    path.free.seen = std::min(path.free.seen, found.free.distance);
  }
  path.corridor.max = path.free.distance;
  path.free.seen = seenByBeams(path.corridor, path.free.seen, last_.scan.origin,
                               {&last_.scan.hits, &last_.scan.clear}, vehicleHeight());
  path.corridor.max = look_ahead;
  path.in_cloud = path.free.blocked &&
                  inCloud(path.corridor, last_, path.free.distance, kSolidAtOnce * stop_.returns);
  if (path.free.blocked) countReturns(last_, path);
  path.returns = std::max(path.returns, static_cast<std::uint32_t>(found.returns));
  return path;
}

FreePath SafetyMonitor::advise(const PathAhead& path, const Scene& scene) {
  FreePath advice;
  advice.distance = path.free.known();
  advice.seen = path.free.seen;
  advice.blocked = path.free.blocked;
  const bool before = near_ && scene.stamp - *near_ <= kFresh;
  near_.reset();
  const double speed = scene.ego.velocity.norm();
  const double way = path.free.known() - path.corridor.from;
  advice.safe_speed = safeSpeed(way, 0, stop_);
  advice.too_fast = speed > advice.safe_speed;
  if (!advice.blocked) return advice;
  const SceneObject* owner = ownerOf(scene, path.free.place, stop_.obstacle_grow);
  const Vector2 ahead =
      (path.corridor.backward ? -1 : 1) * Vector2(scene.ego.T_world_ego.linear().col(0).head<2>());
  const double along = owner == nullptr ? 0 : owner->velocity.dot(ahead);
  advice.owner = owner == nullptr ? 0 : owner->id;
  advice.returns = path.returns, advice.overruled = path.overruled;
  advice.cause = owner != nullptr  ? FreePath::Cause::kObject
                 : path.by_returns ? FreePath::Cause::kReturns
                                   : FreePath::Cause::kGrid;
  if (path.free.seen >= path.free.distance) {
    advice.safe_speed = safeSpeed(way, along, stop_);
    advice.too_fast = speed > advice.safe_speed;
  }
  const bool near = path.free.distance - path.corridor.from < stoppingDistance(speed, along, stop_);
  if (near) near_ = scene.stamp;
  advice.stop = near && (before || !path.in_cloud);
  return advice;
}

void SafetyMonitor::restart() {
  grid_.reset();  // two at once would take twice the memory
  grid_ = makeSafetyGrid(params_);
  places_.clear();
  way_.clear();
  any_ = false;
  near_.reset();
  highest_ = 0;
}

}  // namespace perception
