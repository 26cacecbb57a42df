#include "libperception/pipeline/safety/ObstacleScan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "libperception/grid/beams/WorldPlaces.h"
#include "libperception/lidar/ground/SplitGround.h"
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

/// The largest float not above a number: floats above it are above the number, and no others.
float floatBelow(double number) {
  const auto near = static_cast<float>(number);
  return static_cast<double>(near) > number
             ? std::nextafter(near, -std::numeric_limits<float>::infinity())
             : near;
}
float floatAbove(double number) { return -floatBelow(-number); }

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
        judged_(cloud != nullptr && (!cloud->label.empty() || !cloud->echo.empty())),
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
    const float solid = returns_.solid.empty() ? PlacedReturns::kFewDirections : returns_.solid[i];
    if (!asks && !judged_ && trust > 0)  // most are: nothing is held against them
      return set(hit, 1, 1, doubt, false, solid >= kWall, obstacles);
    // Whether it stands in a cloud matters only where it may be a surface.
    const bool perhaps_surface = solid >= kPerhapsSurface;
    const CausesHere here =
        asks ? frame_.causes.at(place, frame_.stamp, !perhaps_surface) : CausesHere{};
    const double cause = here.likelier();
    float held = std::min(doubt, static_cast<float>(cause));
    if (weighted_ && held < doubt) held = std::max(held, std::min(doubt, verdictOn(i)));
    const bool in_cloud = here.inCloud();
    const bool wall = !in_cloud && solid >= kWall && trust > 0;
    if (wall) held = 0;
    const float weight = 1 - held;
    const float lone = alone && solid < kWall ? static_cast<float>(cause) : 0;
    const float dense = weight * (1 - lone);
    const bool surface = caused_ && perhaps_surface && dense < 1 && trust > 0 &&
                         solid >= (in_cloud ? kWallInCloud : leastOfSurface(i));
    set(hit, weight, dense, doubt, surface, wall, obstacles);
  }

 private:
  void set(std::size_t hit, float weight, float dense, float doubt, bool surface, bool wall,
           ObstacleScan& obstacles) const {
    if (weighted_) obstacles.scan.weights[hit] = weight;
    obstacles.dense[hit] = dense < kDoubted ? 0 : dense;
    obstacles.doubted[hit] = doubt >= kDoubted;
    if (caused_) obstacles.surface[hit] = surface, obstacles.solid[hit] = wall;
  }

  float leastOfSurface(std::size_t i) const {
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
  bool weighted_, judged_, caused_;
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
  scan.hits.reserve(returns.size()), scan.clear.reserve(returns.size());
  scan.weights.reserve(returns.size()), obstacles.dense.reserve(returns.size());
  const bool backward = isReversing(frame.ego.T_world_ego, frame.ego.velocity, stop);
  obstacles.road = RoadHeights(backward);
  const double height_max = std::min(returns.height_max, clearance);
  const SlabRules rules{floatBelow(kMirrored),          floatAbove(kOnRoad),
                        floatBelow(returns.height_min), floatAbove(height_max),
                        backward ? -1.0F : 1.0F,        kBehind};
  WorldPlaces places;
  SlabParts parts;
  constexpr std::size_t kBlock = std::min(WorldPlaces::kSize, SlabParts::kSize);
  for (std::size_t first = 0; first < returns.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, returns.size() - first);
    places.place(frame.ego.T_world_ego, &returns.x[first], &returns.y[first], &returns.z[first],
                 count);
    parts.find(&returns.x[first], &returns.y[first], &returns.height[first], count, rules);
    for (std::size_t k = 0; k < parts.road.count; ++k) {
      const std::size_t i = first + parts.road.index[k];
      obstacles.road.add(returns.x[i], returns.y[i], returns.z[i] - returns.height[i]);
    }
    scan.clear.append(places, parts.others.index.data(), parts.others.count);
    const SlabParts::Part& hits = parts.obstacles;
    scan.hits.append(places, hits.index.data(), hits.count);
    const std::size_t before = obstacles.dense.size();
    doubter.makeRoom(hits.count, obstacles);
    for (std::size_t k = 0; k < hits.count; ++k) {
      const std::uint32_t at = hits.index[k];
      doubter.weigh(first + at, {places.x[at], places.y[at]}, before + k, obstacles);
    }
  }
  return obstacles;
}

}  // namespace perception
