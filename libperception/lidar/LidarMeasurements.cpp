#include "libperception/lidar/LidarMeasurements.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libperception/lidar/outline/FrontShape.h"
#include "libperception/lidar/outline/Outline.h"

namespace perception {
namespace {

/// Indices into LidarFrontEnd::labels().
enum Label { kCarSized, kPersonSized, kUnstable };

constexpr float kLeastOccluderTrust = 0.5f;  // [-] least trust of an occluder

/// A point of the ego frame's x-y plane, `above` [m] over the ground, in the world frame.
Vector3 toWorld(const ScanContext& scan, const Vector2& place, double above) {
  const double ground = scan.found.surface.heightAt(place.x(), place.y());
  return scan.frame.ego.T_world_ego * Vector3(place.x(), place.y(), ground + above);
}

/// Base and height of an object whose returns lie `lowest` to `highest` [m] above the ground at
/// `place` (ego).
void fillVertical(const ScanContext& scan, const Vector2& place, double lowest, double highest,
                  bool partly_hidden, Measurement& m) {
  constexpr double kStandsBelow = 0.5;  // [m] returns below height_min are removed as ground
  constexpr double kBaseSigma = 0.10;   // [m] of the local ground
  constexpr double kTopSigma = 0.10;    // [m] of the highest return
  constexpr double kBeamSpacing =
      0.008;  // [rad] 0.4 deg, HDL-64's lower half: the top lies up to a beam higher
  constexpr double kCutSigma = 1.5;  // [m] when the top is outside the view
  const bool stands = lowest < kStandsBelow;
  const double base = stands ? 0 : lowest;
  const double base_sigma = stands ? std::hypot(kBaseSigma, scan.frame.ground.sigma) : 0.3;
  m.base_z = ScalarEstimate{toWorld(scan, place, base).z(), base_sigma * base_sigma};

  const Vector3 sensor = scan.found.points.sensor;
  const double range = (place - sensor.head<2>()).norm();
  const double ground = scan.found.surface.heightAt(place.x(), place.y());
  const bool cut =
      highest > scan.params.obstacles.height_max - 0.15 ||
      (ground + highest - sensor.z()) / range > scan.found.top_slope - 2 * kBeamSpacing;
  const double top_sigma =
      cut ? kCutSigma : std::hypot(partly_hidden ? 0.3 : kTopSigma, 0.5 * kBeamSpacing * range);
  m.height = ScalarEstimate{highest - base, top_sigma * top_sigma + base_sigma * base_sigma};
}

Outline outlineInWorld(const ScanContext& scan, const std::vector<Vector2>& hull, double above) {
  std::vector<Vector2> places;
  places.reserve(hull.size());
  for (const Vector2& p : hull) places.push_back(toWorld(scan, p, above).head<2>());
  Outline outline = outlineOf(places, scan.T_world_sensor);
  markHiddenEdges(outline, scan.occlusion, scan.T_world_sensor,
                  scan.params.obstacles.occluder_margin, scan.params.obstacles.occluder_bin,
                  scan.fov);
  markEdgesOfField(outline, scan.found.field, yawOf(scan.frame.T_ego_sensor),
                   scan.params.obstacles.occluder_bin);
  return outline;
}

void fillOutline(const ScanContext& scan, Outline outline, const OutlineNoise& noise,
                 Measurement& m) {
  // With both edges hidden the object still stands where a part of it is seen: else the track of a
  // car behind spray drifts sideways for as long as its middle is all that is seen of it.
  constexpr double kHiddenEdge = 2.5;  // [m] that it may go on behind what hides it (assumed)
  const bool both = scan.classified && outline.left_hidden && outline.right_hidden;
  const double edge = both ? kHiddenEdge : noise.sigma_edge;
  if (both) outline.left_hidden = outline.right_hidden = false;
  fillFootprint(outline, std::hypot(noise.sigma_bearing, edge / outline.left_range),
                std::hypot(noise.sigma_bearing, edge / outline.right_range), noise.sigma_range,
                scan.frame.ego.uncertainty, yawOf(scan.T_world_sensor), m);
}

}  // namespace

std::shared_ptr<const OcclusionMap> occlusionMapOf(const LidarDetections& found,
                                                   const Pose3& T_world_ego,
                                                   const Pose3& T_world_sensor,
                                                   const ObstacleParams& params) {
  const auto bins =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(kTwoPi / params.occluder_bin)));
  const Vector2 origin = T_world_sensor.translation().head<2>();
  auto occlusion = std::make_shared<OcclusionMap>(origin, bins);
  struct Bin {
    float nearest2 = std::numeric_limits<float>::infinity(), second2 = nearest2;  ///< [m^2]
  };
  std::vector<Bin> nearest(bins);
  const auto sx = static_cast<float>(found.points.sensor.x()),
             sy = static_cast<float>(found.points.sensor.y());
  const auto world_yaw = static_cast<float>(yawOf(T_world_ego) + 2 * kTwoPi);
  const auto per_radian = static_cast<float>(static_cast<double>(bins) / kTwoPi);
  for (std::size_t i = 0; i < found.x.size(); ++i) {
    if (found.above[i] < static_cast<float>(params.occluder_min) ||
        found.above[i] > static_cast<float>(params.occluder_max) ||
        (!found.trust.empty() && found.trust[i] < kLeastOccluderTrust))
      continue;
    const float dx = found.x[i] - sx, dy = found.y[i] - sy, range2 = dx * dx + dy * dy;
    Bin& bin =
        nearest[static_cast<std::size_t>((fastAtan2(dx, dy) + world_yaw) * per_radian) % bins];
    if (range2 < bin.nearest2) {
      bin.second2 = bin.nearest2, bin.nearest2 = range2;
    } else if (range2 < bin.second2) {
      bin.second2 = range2;
    }
  }
  for (std::size_t k = 0; k < bins; ++k) {
    if (!std::isfinite(nearest[k].second2)) continue;
    const double bearing = (static_cast<double>(k) + 0.5) * kTwoPi / static_cast<double>(bins);
    const double range = std::sqrt(static_cast<double>(nearest[k].second2));
    occlusion->add(origin + range * Vector2(std::cos(bearing), std::sin(bearing)));
  }
  return occlusion;
}

Measurement measurementOf(const ScanContext& scan, const Cluster& cluster) {
  Measurement m;
  const auto lowest = static_cast<double>(cluster.lowest),
             highest = static_cast<double>(cluster.highest);
  const Outline outline = outlineInWorld(scan, cluster.hull, (lowest + highest) / 2);
  fillOutline(scan, outline, cluster.stable ? scan.params.car_noise : scan.params.unstable_noise,
              m);
  m.label = cluster.stable ? kCarSized : kUnstable;

  std::vector<Vector2> places;
  std::vector<double> above;
  places.reserve(cluster.points.size()), above.reserve(cluster.points.size());
  for (const std::uint32_t i : cluster.points) {
    places.emplace_back(static_cast<double>(scan.found.x[i]), static_cast<double>(scan.found.y[i]));
    above.push_back(static_cast<double>(scan.found.above[i]));
  }
  const Vector2 sensor = scan.found.points.sensor.head<2>();
  m.sides = fitBox(places, sensor, !outline.left_hidden, !outline.right_hidden, scan.params.boxes);
  const Vector2 center = m.sides ? m.sides->center : cluster.centroid;
  m.position = toWorld(scan, center, (lowest + highest) / 2).head<2>();
  m.position_sigma = 1;
  if (m.sides) {
    m.sides->yaw = wrapAxis(m.sides->yaw + yawOf(scan.frame.ego.T_world_ego));
    m.sides->yaw_sigma = std::hypot(m.sides->yaw_sigma, scan.frame.ego.uncertainty.sigma_yaw);
    m.sides->center = m.position;
    m.sides->front_log_odds =
        frontLogOdds(places, above, m.sides->yaw - yawOf(scan.frame.ego.T_world_ego));
    m.position_sigma = std::clamp(m.sides->length / 3, 0.5, 2.0);
    if (!cluster.stable)
      m.sides->length_complete = m.sides->width_complete =
          false;  // a neighbor may be part of the same object
  }
  fillVertical(scan, center, lowest, highest, outline.left_hidden || outline.right_hidden, m);
  return m;
}

Measurement measurementOf(const ScanContext& scan, const PersonPeak& peak) {
  Measurement m;
  std::vector<Vector2> places;
  for (const std::uint32_t i : peak.points)
    places.emplace_back(static_cast<double>(scan.found.x[i]), static_cast<double>(scan.found.y[i]));
  const auto lowest = static_cast<double>(peak.lowest), highest = static_cast<double>(peak.highest);
  const Outline outline =
      outlineInWorld(scan, convexHull(std::move(places)), (lowest + highest) / 2);
  fillOutline(scan, outline, scan.params.person_noise, m);
  m.label = kPersonSized;
  m.position = toWorld(scan, peak.center, (lowest + highest) / 2).head<2>();
  m.position_sigma = 0.3;
  fillVertical(scan, peak.center, lowest, highest, outline.left_hidden || outline.right_hidden, m);
  return m;
}

Measurement measurementOf(const ScanContext& scan, const JudgedCluster& cluster, Cluster outline) {
  constexpr double kPersonSize = 1.2;  // [m] longest side (method.md 8.2)
  Measurement m;
  if (sizeOf(outline.hull).longest < kPersonSize) {
    PersonPeak peak;
    peak.points = cluster.points;
    peak.center = outline.centroid;
    peak.lowest = outline.lowest, peak.highest = outline.highest;
    m = measurementOf(scan, peak);
  } else {
    outline.stable = cluster.alone;
    m = measurementOf(scan, outline);
  }
  const Vector2 seen = scan.T_world_sensor.translation().head<2>() - m.position;
  m.view = EvidenceView{std::atan2(seen.y(), seen.x()), std::log(std::max(seen.norm(), 0.1)),
                        static_cast<double>(cluster.points.size())};
  return m;
}

}  // namespace perception
