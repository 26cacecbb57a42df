#include "libperception/simulation/world/World.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace perception {
namespace {

constexpr double kRoadMargin =
    120;  // [m] around the ego's path: beyond it no ground return is detected

Mesh roadAround(const WaypointParams& way, double roughness, bool uniform) {
  const auto [x0, x1] = std::minmax_element(way.x.begin(), way.x.end());
  const auto [y0, y1] = std::minmax_element(way.y.begin(), way.y.end());
  // Centered on whole meters, so that the ground does not change when a waypoint moves a little.
  const Vector2 center(std::round(.5 * (*x0 + *x1)), std::round(.5 * (*y0 + *y1)));
  const double half_side = kRoadMargin + .5 * std::max(*x1 - *x0, *y1 - *y0);
  constexpr double kBumps = 1;  // [m] of the size of a patch of road
  return makeRoad(center, half_side, uniform ? half_side : kBumps, roughness);
}

double distanceToLine(const Vector2& p, const RoadParams& road) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < road.x.size(); ++i) {
    const Vector2 a(road.x[i], road.y[i]), ab = Vector2(road.x[i + 1], road.y[i + 1]) - a;
    const double length2 = ab.squaredNorm();
    const double s = length2 > 0 ? std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0;
    nearest = std::min(nearest, (p - a - s * ab).norm());
  }
  return nearest;
}

// Triangles beside all roads become grass.
void seed(Mesh& ground, const std::vector<RoadParams>& roads) {
  if (roads.empty()) return;
  for (std::size_t k = 0; k < ground.triangles.size(); ++k) {
    Vector2 middle = Vector2::Zero();
    for (const std::uint32_t i : ground.triangles[k]) {
      middle += Vector2(ground.vertices[i][0], ground.vertices[i][1]) / 3;
    }
    const bool asphalt = std::any_of(roads.begin(), roads.end(), [&](const RoadParams& road) {
      return distanceToLine(middle, road) <= .5 * road.width;
    });
    if (!asphalt) ground.materials[k] = Material::kGrass;
  }
}

}  // namespace

World::World(Scenario scenario)
    : scenario_(std::move(scenario)),
      ego_(scenario_.ego.waypoints.trajectory()),
      road_(roadAround(scenario_.ego.waypoints, scenario_.params.ground_roughness,
                       scenario_.params.ground_roughness <= 0 && scenario_.roads.empty())) {
  seed(road_, scenario_.roads);
  for (const ObjectParams& object : scenario_.objects) {
    trajectories_.push_back(object.waypoints.trajectory());
    shapes_.push_back(makeShape(object));
  }
}

Stamp World::stamp(double t) const {
  constexpr std::int64_t kSecond = 1000000000, kTick = 100;  // [ns]
  return {scenario_.params.start_utc * kSecond +
          static_cast<std::int64_t>(std::llround(t * 1e7)) * kTick};
}

EgoState World::ego(double t) const {
  const Motion2 m = ego_.at(t);
  EgoState ego;
  ego.stamp = stamp(t);
  ego.T_world_ego = makePose(m.position.x(), m.position.y(), 0, m.heading);
  ego.velocity = m.velocity;
  ego.yaw_rate = m.yaw_rate;
  ego.uncertainty = {scenario_.ego.pose.sigma_xy, scenario_.ego.pose.sigma_yaw, 0};
  return ego;
}

ObjectState World::object(std::size_t object, double t) const {
  const Motion2 m = trajectories_[object].at(t);
  const double base = scenario_.objects[object].base;
  return {makePose(m.position.x(), m.position.y(), base, m.heading), m.velocity, m.traveled,
          m.yaw_rate};
}

std::vector<Pose3> World::parts(std::size_t index, double t) const {
  const ObjectState state = object(index, t);
  std::vector<Pose3> poses;
  for (const Part& part : shapes_[index].parts) {
    poses.push_back(state.T_world_object *
                    partPose(shapes_[index], part, state.traveled, state.velocity.norm()));
  }
  return poses;
}

std::vector<TruthObject> World::truth(std::int64_t frame, double t) const {
  std::vector<TruthObject> rows;
  for (std::size_t i = 0; i < objects(); ++i) {
    const ObjectParams& params = scenario_.objects[i];
    if (params.kind == ObjectKind::kBox) continue;
    const ObjectState state = object(i, t);
    TruthObject row;
    row.frame = frame;
    row.t = stamp(t) - stamp(0);
    row.id = static_cast<std::int64_t>(i) + 1;
    row.type = truthType(params.kind);
    row.position = state.T_world_object.translation();
    row.yaw = yawOf(state.T_world_object);
    row.length = params.length, row.width = params.width, row.height = params.height;
    row.vx = state.velocity.x(), row.vy = state.velocity.y();
    row.ignore = !isRoadUser(params.kind);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace perception
