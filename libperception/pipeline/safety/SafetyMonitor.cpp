#include "libperception/pipeline/safety/SafetyMonitor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "libperception/grid/beams/WorldPlaces.h"
#include "libperception/grid/way/NearCorridor.h"
#include "libperception/pipeline/safety/Clearance.h"
#include "libperception/weather/SensorVerdict.h"

namespace perception {
namespace {

constexpr double kMirrored = -0.3;  // [m] lower returns are mirror images in a wet road
constexpr double kOnRoad = 0.3;     // [m] lower returns are of the ground
constexpr double kLeaves = 0.5;     // [s] for which a cell belongs to what has left it; assumed
/// [-] distance along the direction of travel by that across it, below which a return lies behind
/// the vehicle (bearings beyond 117 deg): it is ahead only after a turn, during which it is seen
/// anew; assumed.
constexpr float kBehind = -0.5f;
constexpr double kCarHeight = 1.7;  // [m] of a vehicle whose height is not given; assumed
constexpr float kDoubted = 0.5F;    // of a return: more likely a phantom than not
constexpr double kHardly = 0.05;    // doubt that needs no cause, for it decides nothing (assumed)
/// Share of the directions about a return that end there from which it is of a solid surface, and
/// that from which it may be of one: the corner of a surface fills four in nine, among flakes an
/// edge 15 in 25 (assumed).
constexpr float kWall = 0.75F, kPerhapsSurface = 0.4F, kPerhapsAmongFlakes = 0.55F;
/// The same in a wake, whose cloud ends most directions, too: there it has to be seen twice.
constexpr float kWallInWake = 0.9F;
constexpr double kFresh = 0.5;  // [s] after which a scan says nothing of the way ahead; assumed

// The vehicle on the ground plane: z = 0 is the ground.
Pose3 groundPose(const Pose3& T_world_ego, const GroundPlane& plane) {
  return T_world_ego * makePose(0, 0, plane.c, 0, -std::atan(plane.a), std::atan(plane.b));
}

/// Whether of the obstacle returns in the corridor, up to the obstacle and half a meter into it,
/// more are doubted than not.
bool inCloud(const Corridor& corridor, const GridScan& scan, double obstacle) {
  constexpr double kInto = 0.5;  // [m]
  if (scan.weights.size() != scan.hits.size()) return false;
  const Pose3 T_ego_world = corridor.T_world_ego.inverse();
  std::size_t doubted = 0, trusted = 0;
  for (const std::uint32_t i : nearCorridor(corridor, obstacle + kInto, scan.hits)) {
    const Vector3 p = T_ego_world * scan.hits[i];
    const ArcPlace place = arcPlace(corridor, p.x(), p.y());
    if (std::abs(place.d) > corridor.width / 2) continue;
    if (place.s < corridor.from || place.s > obstacle + kInto) continue;
    ++(scan.weights[i] < kDoubted ? doubted : trusted);
  }
  return doubted > trusted;
}

/// Weighs the obstacle returns of one scan.
class Doubter {
 public:
  Doubter(const SensorFrame& frame, const LidarCloud* cloud, const PlacedReturns& returns,
          const TrustParams& params)
      : frame_(frame),
        cloud_(cloud),
        returns_(returns),
        params_(params),
        weighted_(cloud != nullptr && !cloud->trust.empty()),
        caused_(frame.causes.any()) {}

  /// Appends return `i`, a hit at that place in the world.
  void weigh(std::size_t i, const Vector2& place, ObstacleScan& obstacles) const {
    const float trust = weighted_ ? cloud_->trust[returns_.source[i]] : 1;
    const float shape = returns_.phantom.empty() ? 0 : returns_.phantom[i];
    const bool alone = shape == PlacedReturns::kNoCluster;
    const float doubt = 1 - (alone ? trust : trust * (1 - shape));
    const bool asks = caused_ && (alone || static_cast<double>(doubt) > kHardly);
    const CausesHere here = asks ? frame_.causes.at(place, frame_.stamp) : CausesHere{};
    const double cause = here.likelier();
    const float solid = returns_.solid.empty() ? PlacedReturns::kFewDirections : returns_.solid[i];
    float held = std::min(doubt, static_cast<float>(cause));
    if (weighted_) held = std::max(held, std::min(doubt, verdictOn(i)));
    const bool in_wake = here.wake > 0;
    if (!in_wake && solid >= kWall && trust > 0) held = 0;
    const float weight = 1 - held;
    const float lone = alone && solid < kWall ? static_cast<float>(cause) : 0;
    const float dense = weight * (1 - lone);
    if (weighted_) obstacles.scan.weights.push_back(weight);
    obstacles.dense.push_back(dense < kDoubted ? 0 : dense);
    obstacles.doubted.push_back(doubt >= kDoubted);
    if (caused_)
      obstacles.surface.push_back(dense < 1 && trust > 0 &&
                                  solid >= (in_wake ? kWallInWake : perhapsSurface(i)));
  }

 private:
  float perhapsSurface(std::size_t i) const {
    const Vector3 place(returns_.x[i], returns_.y[i], returns_.z[i]);
    const double range = (place - frame_.T_ego_sensor.translation()).norm();
    return range < PlacedReturns::kFlakesWithin ? kPerhapsAmongFlakes : kPerhapsSurface;
  }

  /// What the sensor itself says: a mirror image, rain, dirt.
  float verdictOn(std::size_t i) const {
    const std::uint32_t source = returns_.source[i];
    if (cloud_->trust[source] <= 0) return 1;
    return static_cast<float>(instrumentDoubt(*cloud_, source, params_));
  }

  const SensorFrame& frame_;
  const LidarCloud* cloud_;
  const PlacedReturns& returns_;
  const TrustParams& params_;
  bool weighted_, caused_;
};

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
    const ArcPlace place = arcPlace(path.corridor, p.x(), p.y());
    const double into = place.s - path.free.distance;
    if (std::abs(place.d) > path.corridor.width / 2 || into < -kBefore || into > kInto) continue;
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

ObstacleScan obstacleScanOf(const SensorFrame& frame, const PlacedReturns& returns,
                            const TrustParams& trust, const StopParams& stop, double clearance) {
  ObstacleScan obstacles;
  GridScan& scan = obstacles.scan;
  scan.stamp = frame.stamp;
  scan.origin = frame.T_world_sensor().translation();
  scan.T_world_ground = groundPose(frame.ego.T_world_ego, frame.ground);
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  const Doubter doubter(frame, cloud, returns, trust);
  scan.clear.reserve(returns.size());
  const bool backward = isReversing(frame.ego.T_world_ego, frame.ego.velocity, stop);
  const float travel = backward ? -1 : 1;
  obstacles.road = RoadHeights(backward);
  const double height_max = std::min(returns.height_max, clearance);
  WorldPlaces places;
  std::array<std::uint16_t, WorldPlaces::kSize> hits, clear;
  for (std::size_t first = 0; first < returns.size(); first += WorldPlaces::kSize) {
    const std::size_t count = std::min(WorldPlaces::kSize, returns.size() - first);
    places.place(frame.ego.T_world_ego, &returns.x[first], &returns.y[first], &returns.z[first],
                 count);
    std::size_t hit_count = 0, clear_count = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = first + k;
      const auto height = static_cast<double>(returns.height[i]);
      if (height <= kMirrored || travel * returns.x[i] < kBehind * std::abs(returns.y[i])) continue;
      const bool hit = height > returns.height_min && height < height_max;
      hits[hit_count] = clear[clear_count] = static_cast<std::uint16_t>(k);
      hit_count += hit, clear_count += !hit;
      if (height < kOnRoad)
        obstacles.road.add(returns.x[i], returns.y[i], returns.z[i] - returns.height[i]);
    }
    scan.hits.append(places, hits.data(), hit_count);
    scan.clear.append(places, clear.data(), clear_count);
    for (std::size_t k = 0; k < hit_count; ++k)
      doubter.weigh(first + hits[k], {places.x[hits[k]], places.y[hits[k]]}, obstacles);
  }
  return obstacles;
}

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
  path.in_cloud = path.free.blocked && inCloud(path.corridor, last_.scan, path.free.distance);
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
  grid_ = makeSafetyGrid(params_);
  places_.clear();
  way_.clear();
  any_ = false;
  near_.reset();
  highest_ = 0;
}

}  // namespace perception
