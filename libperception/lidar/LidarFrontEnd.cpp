#include "libperception/lidar/LidarFrontEnd.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "libperception/lidar/Outline.h"
#include "libperception/lidar/SplitGround.h"

namespace perception {

void ObstacleParams::visit(ParamVisitor& v) {
  v.real("height_min", height_min, {0.05, 2}, "m",
         "above ground from which a return is an obstacle (paper)");
  v.real("height_max", height_max, {0.5, 10}, "m",
         "above ground up to which a return is an obstacle");
  v.real("min_trust", min_trust, {0, 1}, "",
         "in a return below which it is a phantom and no obstacle");
  v.real("hiding_min", hiding_min, {0.1, 5}, "m",
         "height from which returns hide what lies behind");
  v.real("hiding_max", hiding_max, {0.2, 10}, "m", "height up to which they do");
  v.angle("hiding_bin_deg", hiding_bin, {0.05, 10}, "width of a direction of the horizon");
  v.real("hiding_margin", hiding_margin, {0, 5}, "m", "by which a hiding return is nearer");
  v.angle(
      "sparse_step_deg", sparse_step, {0, 5},
      "bearing between neighbouring returns: a cluster's end is hidden where the next return of "
      "the same side would be too far off to join; 0: not asked");
  v.require(height_min < height_max, "height_min must be below height_max");
  v.require(hiding_min < hiding_max, "hiding_min must be below hiding_max");
}

void OutlineNoise::visit(ParamVisitor& v) {
  v.real("sigma_edge", sigma_edge, {0.001, 5}, "m", "of an edge, across the line of sight");
  v.angle("sigma_bearing_deg", sigma_bearing, {0, 20},
          "of an edge's bearing, beside sigma_edge / range");
  v.real("sigma_range", sigma_range, {0.001, 5}, "m", "of the nearest point's range");
  v.real("range_share", range_share, {0, 0.5}, "", "further sigma as a share of the range");
}

LidarParams::LidarParams() {
  car_noise = {0.25, radians(0.3), 0.25, 0};
  person_noise = {0.20, radians(0.3), 0.20, 0};
  unstable_noise = {0.25, radians(0.3), 0.40, 0};
}

namespace {

constexpr float kHides = 0.5f;  // [-] trust below which a return is more likely a flake than a wall

enum Label { kCarSized, kPersonSized, kUnstable };

/// Heights of the ground and of the returns that one scan's measurements share.
struct ScanContext {
  const SensorFrame& frame;
  const LidarDetections& found;
  const LidarParams& params;
  Pose3 T_world_sensor;
  const Horizon& horizon;
  double fov;        ///< [rad]
  double top_slope;  ///< [-] tangent of the highest beam's elevation
};

/// The second nearest hiding return of every direction: a single one may be a flake, a drop or a
/// twig.
std::shared_ptr<const Horizon> horizonOf(const LidarDetections& found, const Pose3& T_world_ego,
                                         const Pose3& T_world_sensor,
                                         const ObstacleParams& params) {
  const auto bins =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(kTwoPi / params.hiding_bin)));
  const Vector2 origin = T_world_sensor.translation().head<2>();
  auto horizon = std::make_shared<Horizon>(origin, bins);
  struct Bin {
    float nearest2 = std::numeric_limits<float>::infinity(), second2 = nearest2;  ///< [m^2]
  };
  std::vector<Bin> nearest(bins);
  const auto sx = static_cast<float>(found.points.sensor.x()),
             sy = static_cast<float>(found.points.sensor.y());
  const auto world_yaw = static_cast<float>(yawOf(T_world_ego) + 2 * kTwoPi);
  const auto per_radian = static_cast<float>(static_cast<double>(bins) / kTwoPi);
  for (std::size_t i = 0; i < found.x.size(); ++i) {
    if (found.above[i] < static_cast<float>(params.hiding_min) ||
        found.above[i] > static_cast<float>(params.hiding_max) ||
        (!found.trust.empty() && found.trust[i] < kHides))
      continue;
    const float dx = found.x[i] - sx, dy = found.y[i] - sy, range2 = dx * dx + dy * dy;
    Bin& bin =
        nearest[static_cast<std::size_t>((roughBearing(dx, dy) + world_yaw) * per_radian) % bins];
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
    horizon->add(origin + range * Vector2(std::cos(bearing), std::sin(bearing)));
  }
  return horizon;
}

/// A sample of the returns tells as much: the highest beam has its share of them.
double topSlope(const LidarDetections& found) {
  constexpr std::size_t kSample = 16000;
  const EgoPoints& points = found.points;
  const auto sx = static_cast<float>(points.sensor.x()), sy = static_cast<float>(points.sensor.y()),
             sz = static_cast<float>(points.sensor.z());
  const std::size_t stride = 1 + points.size() / kSample;
  float top = -std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const float dx = points.x[i] - sx, dy = points.y[i] - sy;
    top = std::max(top, (points.z[i] - sz) / std::sqrt(dx * dx + dy * dy));
  }
  return static_cast<double>(top);
}

/// Places of the ego frame's plane in the world, at the ground's height plus `above` [m].
Vector3 toWorld(const ScanContext& scan, const Vector2& place, double above) {
  const double ground = scan.found.surface.heightAt(place.x(), place.y());
  return scan.frame.ego.T_world_ego * Vector3(place.x(), place.y(), ground + above);
}

/// Base and height of an object whose returns lie `lowest` to `highest` [m] above the ground at
/// `place` (ego).
void fillVertical(const ScanContext& scan, const Vector2& place, double lowest, double highest,
                  bool partly_hidden, Measurement& m) {
  constexpr double kStandsBelow =
      0.5;  // [m] returns begin at height_min: lower ones are cut as ground
  constexpr double kBaseSigma = 0.10;  // [m] of the local ground
  constexpr double kTopSigma = 0.10;   // [m] of the highest return
  constexpr double kBeamSpacing =
      0.008;  // [rad] 0.4 deg, HDL-64's lower half: the top lies up to a beam higher
  constexpr double kCutSigma = 1.5;  // [m] the top is not in the returns
  const bool stands = lowest < kStandsBelow;
  const double base = stands ? 0 : lowest;
  const double base_sigma = stands ? std::hypot(kBaseSigma, scan.frame.ground.sigma) : 0.3;
  m.base_z = ScalarEstimate{toWorld(scan, place, base).z(), base_sigma * base_sigma};

  const Vector3 sensor = scan.found.points.sensor;
  const double range = (place - sensor.head<2>()).norm();
  const double ground = scan.found.surface.heightAt(place.x(), place.y());
  const bool cut = highest > scan.params.obstacles.height_max - 0.15 ||
                   (ground + highest - sensor.z()) / range > scan.top_slope - 2 * kBeamSpacing;
  const double top_sigma =
      cut ? kCutSigma : std::hypot(partly_hidden ? 0.3 : kTopSigma, 0.5 * kBeamSpacing * range);
  m.height = ScalarEstimate{highest - base, top_sigma * top_sigma + base_sigma * base_sigma};
}

/// Places and heights of the obstacles, and trust in them.
void takeObstacles(const LidarCloud& cloud, LidarDetections& found) {
  const EgoPoints& points = found.points;
  const std::size_t obstacles = found.obstacles.size();
  found.x.resize(obstacles), found.y.resize(obstacles), found.above.resize(obstacles);
  for (std::size_t k = 0; k < obstacles; ++k) {
    const std::uint32_t i = found.obstacles[k];
    found.x[k] = points.x[i], found.y[k] = points.y[i], found.above[k] = found.height[i];
  }
  if (cloud.trust.size() != cloud.size()) return;
  found.trust.resize(obstacles);
  for (std::size_t k = 0; k < obstacles; ++k)
    found.trust[k] = cloud.trust[points.source[found.obstacles[k]]];
}

/// Trust in a return of the obstacles.
double trustIn(const LidarDetections& found, std::uint32_t i) {
  return found.trust.empty() ? 1.0 : static_cast<double>(found.trust[i]);
}

double trustIn(const LidarDetections& found, const std::vector<std::uint32_t>& returns) {
  double sum = 0;
  for (const std::uint32_t i : returns) sum += trustIn(found, i);
  return sum;
}

/// One object, one detection, and no return in two: where a peak lies in a cluster's hull, one of
/// the two goes or they are parted. A peak that explains most of a short cluster is a person with
/// legs apart; one that is the middle of something rider-sized belongs to it; else the cluster is
/// something larger and the peak its corner (SPEC 8.3). A clear peak beside something unstable is a
/// person standing close to it: its returns leave the cluster.
void settleOverlaps(LidarDetections& found, const PersonParams& params,
                    const ClusterParams& cluster_params) {
  std::vector<std::uint8_t> drop_cluster(found.clusters.size(), 0),
      drop_peak(found.persons.size(), 0);
  std::vector<Eigen::AlignedBox2d> about;
  for (const Cluster& cluster : found.clusters) {
    Eigen::AlignedBox2d box;
    for (const Vector2& corner : cluster.hull) box.extend(corner);
    about.push_back(box);
  }
  for (std::size_t p = 0; p < found.persons.size(); ++p) {
    const PersonPeak& peak = found.persons[p];
    for (std::size_t c = 0; c < found.clusters.size(); ++c) {
      Cluster& cluster = found.clusters[c];
      if (drop_cluster[c] || about[c].exteriorDistance(peak.centre) >= params.hull_margin ||
          distanceToHull(cluster.hull, peak.centre) >= params.hull_margin)
        continue;
      const double longest = sizeOf(cluster.hull).longest;
      std::vector<std::uint32_t> shared;
      std::set_intersection(peak.points.begin(), peak.points.end(), cluster.points.begin(),
                            cluster.points.end(), std::back_inserter(shared));
      const double share = trustIn(found, shared) / trustIn(found, cluster.points);
      if (longest < cluster_params.min_side && share >= params.whole_share) {
        drop_cluster[c] = 1;
      } else if (cluster.stable || peak.normalised < params.crowd_threshold ||
                 (longest < params.rider_size && share >= params.part_share)) {
        drop_peak[p] = 1;
      } else if (!shared.empty()) {
        std::vector<std::uint32_t> rest;
        std::set_difference(cluster.points.begin(), cluster.points.end(), shared.begin(),
                            shared.end(), std::back_inserter(rest));
        cluster.points = std::move(rest);
        drop_cluster[c] = trustIn(found, cluster.points) < cluster_params.min_points - 1e-6;
        if (drop_cluster[c]) continue;
        describeCluster(found.x, found.y, found.above, cluster);
        drop_cluster[c] = !hasCarSize(cluster, cluster_params);
      }
    }
  }
  for (std::size_t c = found.clusters.size(); c-- > 0;)
    if (drop_cluster[c])
      found.clusters.erase(found.clusters.begin() + static_cast<std::ptrdiff_t>(c));
  for (std::size_t p = found.persons.size(); p-- > 0;)
    if (drop_peak[p]) found.persons.erase(found.persons.begin() + static_cast<std::ptrdiff_t>(p));
}

Outline outlineInWorld(const ScanContext& scan, const std::vector<Vector2>& hull, double above) {
  std::vector<Vector2> places;
  places.reserve(hull.size());
  for (const Vector2& p : hull) places.push_back(toWorld(scan, p, above).head<2>());
  Outline outline = outlineOf(places, scan.T_world_sensor);
  markHiddenEdges(outline, scan.horizon, scan.T_world_sensor, scan.params.obstacles.hiding_margin,
                  scan.params.obstacles.hiding_bin, scan.fov);
  if (scan.params.obstacles.sparse_step > 0)
    markSparseEdges(outline, places, scan.T_world_sensor, scan.params.obstacles.sparse_step,
                    scan.params.clusters.near_threshold);
  return outline;
}

void fillOutline(const ScanContext& scan, const Outline& outline, const OutlineNoise& noise,
                 Measurement& m) {
  fillFootprint(outline, std::hypot(noise.sigma_bearing, noise.sigma_edge / outline.left_range),
                std::hypot(noise.sigma_bearing, noise.sigma_edge / outline.right_range),
                noise.sigma_range + noise.range_share * outline.nearest, scan.frame.ego.uncertainty,
                yawOf(scan.T_world_sensor), m);
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
  places.reserve(cluster.points.size());
  for (const std::uint32_t i : cluster.points)
    places.emplace_back(static_cast<double>(scan.found.x[i]), static_cast<double>(scan.found.y[i]));
  const Vector2 sensor = scan.found.points.sensor.head<2>();
  m.sides = fitBox(places, sensor, !outline.left_hidden, !outline.right_hidden, scan.params.boxes);
  const Vector2 centre = m.sides ? m.sides->centre : cluster.centroid;
  m.position = toWorld(scan, centre, (lowest + highest) / 2).head<2>();
  m.position_sigma = 1;
  if (m.sides) {
    m.sides->yaw = wrapAxis(m.sides->yaw + yawOf(scan.frame.ego.T_world_ego));
    m.sides->yaw_sigma = std::hypot(m.sides->yaw_sigma, scan.frame.ego.uncertainty.sigma_yaw);
    m.sides->centre = m.position;
    m.position_sigma = std::clamp(m.sides->a / 3, 0.5, 2.0);
    if (!cluster.stable)
      m.sides->a_complete = m.sides->b_complete = false;  // its neighbour may be the same object
  }
  fillVertical(scan, centre, lowest, highest, outline.left_hidden || outline.right_hidden, m);
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
  m.position = toWorld(scan, peak.centre, (lowest + highest) / 2).head<2>();
  m.position_sigma = 0.3;
  fillVertical(scan, peak.centre, lowest, highest, outline.left_hidden || outline.right_hidden, m);
  return m;
}

}  // namespace

std::vector<std::string> LidarFrontEnd::labels(const ClusterParams& clusters) {
  std::vector<std::string> names = {"car_sized", "person_sized"};
  if (clusters.accept_unstable) names.emplace_back("unstable");
  return names;
}

LidarFrontEnd::LidarFrontEnd(const LidarParams& params, const ClassTable& classes,
                             const Sensing& sensing)
    : params_(params),
      fov_(sensing.params().fov),
      model_(std::make_shared<FootprintModel>(classes, sensing)) {}

LidarDetections LidarFrontEnd::detect(const SensorFrame& frame) const {
  EgoPoints points = usablePoints(frame, params_.points);
  std::vector<float> height;
  GroundSurface surface(frame.ground, points, params_.surface, &height);
  LidarDetections found(std::move(points), std::move(height), std::move(surface));
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  if (cloud == nullptr) return found;
  const ObstacleParams& obstacles = params_.obstacles;
  splitGround(*cloud, found.points, found.height,
              {obstacles.height_min, obstacles.height_max, obstacles.min_trust}, found.ground,
              found.obstacles);
  takeObstacles(*cloud, found);
  found.clusters = findClusters(found.x, found.y, found.above, params_.clusters, found.trust);
  found.persons = findPersons(found.x, found.y, found.above, params_.persons, found.trust,
                              found.points.sensor.head<2>());
  settleOverlaps(found, params_.persons, params_.clusters);
  return found;
}

std::vector<Vector3> LidarFrontEnd::obstaclePoints(const SensorFrame& frame) const {
  const LidarDetections found = detect(frame);
  std::vector<Vector3> points;
  points.reserve(found.obstacles.size());
  for (const std::uint32_t i : found.obstacles)
    points.emplace_back(static_cast<double>(found.points.x[i]),
                        static_cast<double>(found.points.y[i]),
                        static_cast<double>(found.points.z[i]));
  return points;
}

MeasurementScan LidarFrontEnd::extract(const SensorFrame& frame) const {
  const LidarDetections found = detect(frame);
  MeasurementScan scan;
  scan.dropped_points = found.points.dropped + found.points.capped;
  scan.sensor = frame.sensor;
  scan.modality = model_->sensing().params().modality;
  scan.frame = frame.frame;
  scan.state = {frame.stamp, frame.T_world_sensor(), frame.ego};
  scan.model = model_;
  const auto horizon =
      horizonOf(found, frame.ego.T_world_ego, scan.state.T_world_sensor, params_.obstacles);
  scan.horizon = horizon;

  const ScanContext context{frame,    found, params_,        scan.state.T_world_sensor,
                            *horizon, fov_,  topSlope(found)};
  const Vector2 sensor = found.points.sensor.head<2>();
  const auto add = [&scan](Measurement m) {
    m.detection = static_cast<int>(scan.measurements.size());
    scan.measurements.push_back(std::move(m));
  };
  for (const Cluster& cluster : found.clusters)
    if (distanceToHull(cluster.hull, sensor) > 0) add(measurementOf(context, cluster));
  for (const PersonPeak& peak : found.persons) add(measurementOf(context, peak));
  return scan;
}

std::unique_ptr<FrontEnd> makeLidarFrontEnd(Config& config, const std::string& sensor_label,
                                            const ClassTable& classes) {
  const std::string section = "sensor." + sensor_label;
  LidarParams params;
  params.points = config.read(section + ".points", params.points);
  params.surface = config.read(section + ".surface", params.surface);
  params.obstacles = config.read(section + ".obstacles", params.obstacles);
  params.clusters = config.read(section + ".clusters", params.clusters);
  params.persons = config.read(section + ".persons", params.persons);
  params.boxes = config.read(section + ".boxes", params.boxes);
  params.car_noise = config.read(section + ".noise.car_sized", params.car_noise);
  params.person_noise = config.read(section + ".noise.person_sized", params.person_noise);
  if (params.clusters.accept_unstable)
    params.unstable_noise = config.read(section + ".noise.unstable", params.unstable_noise);

  SensingParams defaults;  // lidar defaults of SPEC 2 and 5.3 are SensingParams' own
  defaults.kind = "lidar";
  defaults.modality = Modality::kLidar;
  const Sensing sensing =
      Sensing::read(config, section, classes, LidarFrontEnd::labels(params.clusters), defaults);
  return std::make_unique<LidarFrontEnd>(params, classes, sensing);
}

}  // namespace perception
