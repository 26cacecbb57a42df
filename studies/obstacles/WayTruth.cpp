#include "studies/obstacles/WayTruth.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "libperception/calibration/clusters/PointLabels.h"
#include "libperception/lidar/linkage/SpaceLinkage.h"

namespace perception {
namespace {

constexpr double kMemory = 0.55;           // [s] half a second of scans at 10 Hz
constexpr double kBorder = 1;              // [m]
constexpr int kSureScans = 3;              // a grid needs two scans, one is spare
constexpr std::size_t kTogether = 3;       // returns
constexpr double kWithinWay = 0.5;         // [m]
constexpr float kLink = 0.7F;              // [m]
constexpr std::size_t kClusterLeast = 10;  // returns
constexpr double kOutline = 0.5;           // [m] by which a box is grown
constexpr double kSameInstant = 0.06;      // [s]
constexpr double kNowhere = std::numeric_limits<double>::infinity();

// SemanticKITTI's ground: road, parking, sidewalk, other ground, lane marking, terrain, lying snow.
bool isGround(std::uint16_t label) {
  return label == 40 || label == 44 || label == 48 || label == 49 || label == 60 || label == 72 ||
         label == 111;
}

/// [m] along the arc; infinity outside of the corridor.
double alongCorridor(double x, double y, const Corridor& corridor) {
  const ArcPlace at = arcPlace(corridor, x, y);
  const bool in =
      std::abs(at.d) <= corridor.width / 2 && at.s >= corridor.from && at.s <= corridor.max;
  return in ? at.s : kNowhere;
}

}  // namespace

LabeledObstacles obstaclesOf(const PlacedReturns& returns, const Pose3& T_world_ego,
                             const std::vector<std::uint16_t>& labels) {
  LabeledObstacles found;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const auto height = static_cast<double>(returns.height[i]);
    if (height <= returns.height_min || height >= returns.height_max) continue;
    const std::uint16_t label = labels[returns.source[i]];
    found.x.push_back(returns.x[i]);
    found.y.push_back(returns.y[i]);
    found.z.push_back(returns.z[i]);
    found.place.push_back(T_world_ego * Vector3(static_cast<double>(returns.x[i]),
                                                static_cast<double>(returns.y[i]),
                                                static_cast<double>(returns.z[i])));
    found.phantom.push_back(isPhantomLabel(label));
    found.surface.push_back(!isPhantomLabel(label) && !isGround(label));
  }
  return found;
}

Ahead nearestInCorridor(const std::vector<Vector3>& places, const Corridor& corridor) {
  const Pose3 T_ego_world = corridor.T_world_ego.inverse();
  std::vector<Ahead> inside;
  for (const Vector3& place : places) {
    const Vector3 p = T_ego_world * place;
    const double s = alongCorridor(p.x(), p.y(), corridor);
    if (s < kNowhere) inside.push_back({s, place});
  }
  std::sort(inside.begin(), inside.end(), [](const Ahead& a, const Ahead& b) { return a.s < b.s; });
  for (std::size_t i = 0; i + kTogether <= inside.size(); ++i)
    if (inside[i + kTogether - 1].s - inside[i].s <= kWithinWay) return inside[i];
  return {};
}

Ahead nearestCluster(const LabeledObstacles& obstacles, const Corridor& corridor) {
  std::vector<LinkedReturn> returns;
  for (std::size_t i = 0; i < obstacles.x.size(); ++i)
    returns.push_back({obstacles.x[i], obstacles.y[i], obstacles.z[i], kLink});
  const Partition clusters = linkInSpace(returns, kLink, kLink);
  std::vector<std::size_t> sizes(clusters.count);
  for (const std::uint32_t group : clusters.group) ++sizes[group];
  Ahead nearest;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (sizes[clusters.group[i]] < kClusterLeast) continue;
    const double s = alongCorridor(static_cast<double>(obstacles.x[i]),
                                   static_cast<double>(obstacles.y[i]), corridor);
    if (s < nearest.s) nearest = {s, obstacles.place[i]};
  }
  return nearest;
}

TruthSpeeds::TruthSpeeds(const std::string& rawlog) {
  if (std::filesystem::exists(truthFileOf(rawlog))) truth_ = truthBeside(rawlog);
}

Vector2 TruthSpeeds::at(double t, const Vector3& place) const {
  const auto& instants = truth_.instants;
  auto now = std::lower_bound(
      instants.begin(), instants.end(), t - kSameInstant,
      [](const GroundTruth::Instant& instant, double at) { return instant.t < at; });
  if (now == instants.end() || now->t > t + kSameInstant) return Vector2::Zero();
  for (const TruthObject& o : now->objects) {
    const Vector2 p = rotate2(-o.yaw, place.head<2>() - Vector2(o.position.head<2>()));
    const bool in =
        std::abs(p.x()) <= o.length / 2 + kOutline && std::abs(p.y()) <= o.width / 2 + kOutline;
    if (in && std::isfinite(o.vx)) return {o.vx, o.vy};
  }
  return Vector2::Zero();
}

double StopRule::within(const Ahead& obstacle, const Vector2& velocity) const {
  const double along = velocity.dot(corridor.T_world_ego.linear().col(0).head<2>());
  return corridor.from + stoppingDistance(speed, along, params) - obstacle.s;
}

double StopRule::within(const Ahead& obstacle) const {
  return within(obstacle,
                std::isfinite(obstacle.s) ? speeds->at(t, obstacle.place) : Vector2::Zero());
}

void WayTruth::add(Stamp stamp, double t, const LabeledObstacles& obstacles,
                   const TruthSpeeds& speeds) {
  Scan scan{stamp, {}, {}};
  for (std::size_t i = 0; i < obstacles.place.size(); ++i) {
    if (!obstacles.surface[i]) continue;
    scan.places.push_back(obstacles.place[i]);
    scan.velocities.push_back(speeds.at(t, obstacles.place[i]));
  }
  scans_.push_back(std::move(scan));
  while (stamp - scans_.front().stamp > kMemory) scans_.pop_front();
}

InTheWay WayTruth::judge(Stamp stamp, const StopRule& rule) {
  const bool now = !scans_.empty() && scans_.back().stamp == stamp &&
                   rule.within(nearestInCorridor(scans_.back().places, rule.corridor)) > kBorder;
  sure_scans_ = now ? sure_scans_ + 1 : 0;
  if (sure_scans_ >= kSureScans) return InTheWay::kYes;
  Corridor wide = rule.corridor;
  wide.width += kBorder;
  const Pose3 T_ego_world = wide.T_world_ego.inverse();
  for (const Scan& scan : scans_) {
    for (std::size_t i = 0; i < scan.places.size(); ++i) {
      Vector3 place = scan.places[i];
      place.head<2>() += scan.velocities[i] * (stamp - scan.stamp);
      const Vector3 p = T_ego_world * place;
      const Ahead ahead{alongCorridor(p.x(), p.y(), wide), place};
      if (rule.within(ahead, scan.velocities[i]) > -kBorder) return InTheWay::kPerhaps;
    }
  }
  return InTheWay::kNo;
}

}  // namespace perception
