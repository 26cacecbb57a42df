#include "libperception/app/SnapshotLidar.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "libperception/lidar/EgoPoints.h"
#include "libperception/lidar/GroundSurface.h"
#include "libperception/lidar/LidarFrontEnd.h"  // ObstacleParams
#include "libperception/sensors/Conversions.h"

namespace perception {
namespace {

constexpr double kPoseGap =
    1.5;  // [s] between scenes over which the vehicle's place is interpolated
constexpr double kLastScan = 0.5;   // [s] after which returns are too old to be drawn
constexpr double kMirrored = -0.3;  // [m] lower returns are mirror images in a wet road (SPEC 8.1)
constexpr double kSteers = 2;       // [m/s] below it yaw rate and speed tell no curvature
constexpr double kSharpest = 0.2;   // [1/m] of a car's steering

// The vehicle on the ground plane: z = 0 is the ground.
Pose3 groundPose(const Pose3& T_world_ego, const GroundPlane& plane) {
  return T_world_ego * makePose(0, 0, plane.c, 0, -std::atan(plane.a), std::atan(plane.b));
}

Corridor laneOf(const EgoState& ego) {
  Corridor lane;
  lane.T_world_ego = ego.T_world_ego;
  lane.from = PointParams{}.vehicle_front;
  const double speed = ego.velocity.norm();
  if (speed > kSteers) lane.curvature = std::clamp(ego.yaw_rate / speed, -kSharpest, kSharpest);
  return lane;
}

}  // namespace

SnapshotLidar::SnapshotLidar(const std::string& log, const TrackedRun& run, const GridParams& grid,
                             const GroundParams& ground, double memory)
    : reader_(log), run_(run), ground_(ground), memory_(memory), grid_(makeSafetyGrid(grid)) {}

void SnapshotLidar::advanceTo(Stamp stamp) {
  now_ = stamp;
  while (true) {
    if (!next_) next_ = reader_.next();
    if (!next_) return;
    if (isSensorData(*next_)) {
      const auto at = toStamp(next_->timestamp);
      if (at && *at > stamp) return;
      if (at && stamp - *at <= memory_) {
        if (auto frame = frameFromObservation(*next_)) take(std::move(*frame));
      }
    }
    next_.reset();
  }
}

std::optional<EgoState> SnapshotLidar::egoAt(Stamp stamp) const {
  const auto after = std::lower_bound(run_.scenes.begin(), run_.scenes.end(), stamp,
                                      [](const Scene& s, Stamp t) { return s.stamp < t; });
  if (after == run_.scenes.end()) return std::nullopt;
  if (after->stamp == stamp) return after->ego;
  if (after == run_.scenes.begin()) return std::nullopt;
  const EgoState &a = std::prev(after)->ego, &b = after->ego;
  const double gap = after->stamp - std::prev(after)->stamp;
  if (gap > kPoseGap) return std::nullopt;
  const double share = (stamp - std::prev(after)->stamp) / gap;
  EgoState ego = a;
  ego.stamp = stamp;
  ego.T_world_ego.translation() +=
      share * (b.T_world_ego.translation() - a.T_world_ego.translation());
  ego.T_world_ego.linear() = Eigen::Quaterniond(a.T_world_ego.linear())
                                 .slerp(share, Eigen::Quaterniond(b.T_world_ego.linear()))
                                 .toRotationMatrix();
  return ego;
}

void SnapshotLidar::take(SensorFrame frame) {
  if (!std::holds_alternative<LidarCloud>(frame.data)) return;
  const auto ego = egoAt(frame.stamp);
  if (!ego) return;
  frame.ego = *ego;
  const auto seed = lidars_.size();
  Lidar& lidar = lidars_.try_emplace(frame.sensor, Lidar{GroundEstimator(ground_, seed), {}, {}})
                     .first->second;
  frame.ground = lidar.ground.update(frame);
  const EgoPoints points = usablePoints(frame, PointParams{});
  const std::vector<float> heights =
      GroundSurface(frame.ground, points, SurfaceParams{}).heightsAbove(points);

  const ObstacleParams obstacles;
  GridScan scan;
  scan.stamp = frame.stamp;
  scan.origin = frame.T_world_sensor().translation();
  scan.T_world_ground = groundPose(ego->T_world_ego, frame.ground);
  lidar.stamp = frame.stamp;
  lidar.points.clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3 place = ego->T_world_ego * Vector3(points.x[i], points.y[i], points.z[i]);
    const bool hit = heights[i] > obstacles.height_min && heights[i] < obstacles.height_max;
    if (heights[i] > kMirrored) (hit ? scan.hits : scan.clear).push_back(place);
    lidar.points.push_back({place, heights[i]});
  }
  grid_->insert(scan);
  ++scans_;
}

void SnapshotLidar::fill(SceneView& view) const {
  view.has_lidar = true;
  for (const auto& [label, lidar] : lidars_) {
    if (now_ - lidar.stamp > kLastScan) continue;
    view.points.insert(view.points.end(), lidar.points.begin(), lidar.points.end());
  }
  view.occupied = grid_->occupiedCells();
  if (lidars_.empty()) return;
  view.corridor = laneOf(view.scene.ego);
  view.free = grid_->freeDistance(*view.corridor);
}

}  // namespace perception
