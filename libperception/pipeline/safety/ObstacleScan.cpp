#include "libperception/pipeline/safety/ObstacleScan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "libperception/grid/beams/WorldPlaces.h"
#include "libperception/weather/SensorVerdict.h"

namespace perception {
namespace {

constexpr double kMirrored = -0.3;  // [m] lower returns are mirror images in a wet road
constexpr double kOnRoad = 0.3;     // [m] lower returns are of the ground
/// [-] distance along the direction of travel by that across it, below which a return lies behind
/// the vehicle (bearings beyond 117 deg): it is ahead only after a turn, during which it is seen
/// anew; assumed.
constexpr float kBehind = -0.5f;
constexpr double kHardly = 0.05;  // doubt that needs no cause, for it decides nothing (assumed)
/// Share of the directions about a return that end there from which it is of a solid surface, and
/// that from which it may be of one: the corner of a surface fills four in nine, among flakes an
/// edge 15 in 25 (assumed).
constexpr float kWall = 0.75F, kPerhapsSurface = 0.4F, kPerhapsAmongFlakes = 0.55F;
/// The same in a wake or a cloud, which ends most directions, too: there it has to be seen twice.
constexpr float kWallInCloud = 0.9F;

// The vehicle on the ground plane: z = 0 is the ground.
Pose3 groundPose(const Pose3& T_world_ego, const GroundPlane& plane) {
  return T_world_ego * makePose(0, 0, plane.c, 0, -std::atan(plane.a), std::atan(plane.b));
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

  /// Makes room for as many hits more.
  void makeRoom(std::size_t hits, ObstacleScan& obstacles) const {
    const std::size_t all = obstacles.dense.size() + hits;
    if (weighted_) obstacles.scan.weights.resize(all);
    obstacles.dense.resize(all), obstacles.doubted.resize(all);
    if (caused_) obstacles.surface.resize(all), obstacles.solid.resize(all);
  }
  /// Sets hit `hit`: return `i`, at that place in the world.
  void weigh(std::size_t i, const Vector2& place, std::size_t hit, ObstacleScan& obstacles) const {
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
    const bool in_cloud = here.inCloud();
    const bool wall = !in_cloud && solid >= kWall && trust > 0;
    if (wall) held = 0;
    const float weight = 1 - held;
    const float lone = alone && solid < kWall ? static_cast<float>(cause) : 0;
    const float dense = weight * (1 - lone);
    if (weighted_) obstacles.scan.weights[hit] = weight;
    obstacles.dense[hit] = dense < kDoubted ? 0 : dense;
    obstacles.doubted[hit] = doubt >= kDoubted;
    if (!caused_) return;
    obstacles.surface[hit] =
        dense < 1 && trust > 0 && solid >= (in_cloud ? kWallInCloud : perhapsSurface(i));
    obstacles.solid[hit] = wall;
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
    const std::size_t before = obstacles.dense.size();
    doubter.makeRoom(hit_count, obstacles);
    for (std::size_t k = 0; k < hit_count; ++k)
      doubter.weigh(first + hits[k], {places.x[hits[k]], places.y[hits[k]]}, before + k, obstacles);
  }
  return obstacles;
}

}  // namespace perception
