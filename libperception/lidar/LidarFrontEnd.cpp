#include "libperception/lidar/LidarFrontEnd.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "libperception/core/system/Parallel.h"
#include "libperception/lidar/LidarMeasurements.h"
#include "libperception/lidar/classification/JudgedClusters.h"
#include "libperception/lidar/ground/SplitGround.h"
#include "libperception/lidar/outline/RadialMotion.h"
#include "libperception/lidar/segments/LooseReturns.h"
#include "libperception/lidar/two_spacings/Overlaps.h"

namespace perception {

void ObstacleParams::visit(ParamVisitor& v) {
  v.real("height_min", height_min, {0.05, 2}, "m",
         "least height above ground of an obstacle return");
  v.real("occluder_min", occluder_min, {0.1, 5}, "m", "least height above ground of an occluder");
  v.expert();
  v.real("height_max", height_max, {0.5, 10}, "m",
         "largest height above ground of an obstacle return");
  v.real("occluder_max", occluder_max, {0.2, 10}, "m",
         "largest height above ground of an occluder");
  v.require(height_min < height_max, "height_min must be below height_max");
  v.require(occluder_min < occluder_max, "occluder_min must be below occluder_max");
}

void OutlineNoise::visit(ParamVisitor& v) {
  v.expert();
  v.real("sigma_edge", sigma_edge, {0.001, 5}, "m", "noise of an edge, across the line of sight");
  v.angle("sigma_bearing_deg", sigma_bearing, {0, 20},
          "noise of an edge's bearing, besides sigma_edge / range");
  v.real("sigma_range", sigma_range, {0.001, 5}, "m", "noise of the range of the nearest point");
}

LidarParams::LidarParams() {
  person_noise = {0.20, radians(0.3), 0.20};
  unstable_noise = {0.25, radians(0.3), 0.40};
}

namespace {

/// Footprints whose class is told by the shape of their returns.
class ClusterModel final : public FootprintModel {
 public:
  ClusterModel(ClassTable classes, DetectionModel detection_model, const EvidenceMemory& memory)
      : FootprintModel(std::move(classes), std::move(detection_model)), memory_(memory) {}
  const EvidenceMemory* evidenceMemory() const override { return &memory_; }
  /// The width of an outline is in the shape already, and stays what it is from scan to scan; tuned
  /// on KITTI 0000.
  double innovationShare() const override { return 0.1; }
  double detectionProbability(ClassId c, const Kinematics& object, const Extent& extent,
                              const SensorState& sensor, double visibility) const override {
    // Of what goes over the view's border the part within gives a cluster: all of P_D as long as a
    // quarter of its width is within (assumed).
    constexpr double kEnough = 0.25;
    const double distance =
        (object.q.head<2>() - sensor.T_world_sensor.translation().head<2>()).norm();
    const double nearest = std::max(0.0, distance - 0.25 * (extent.length + extent.width));
    const double share = std::min(1.0, shareInView(object, extent, sensor) / kEnough);
    return share * detection_model().detection(c, nearest, 0, visibility);
  }

 private:
  EvidenceMemory memory_;
};

/// Takes obstacles out that lie beyond `reach` [m] from the sensor by more than what is looked at
/// of an object that begins within: none of theirs would be measured.
void dropUnreachable(const EgoPoints& points, double reach, std::vector<std::uint32_t>& obstacles) {
  constexpr double kInto = 10;  // [m] of such an object: a truck, most of a bus (assumed)
  const auto sx = static_cast<float>(points.sensor.x()), sy = static_cast<float>(points.sensor.y()),
             most = static_cast<float>((reach + kInto) * (reach + kInto));
  std::size_t kept = 0;
  for (const std::uint32_t i : obstacles) {
    const float dx = points.x[i] - sx, dy = points.y[i] - sy;
    obstacles[kept] = i;
    kept += dx * dx + dy * dy <= most;
  }
  obstacles.resize(kept);
}

/// Positions, heights and trust of the obstacles.
void gatherObstacles(const LidarCloud& cloud, LidarDetections& found) {
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

/// Shares of solid directions about the returns of the slab of obstacles: in weather of all,
/// elsewhere of those that are doubted, for these alone may stand in a wake.
void describeSolid(const SensorFrame& frame, const LidarCloud& cloud, const ObstacleParams& params,
                   const DirectionCells& cells, LidarDetections& found) {
  std::vector<std::uint32_t> slab = heightsBetween(
      found.height, static_cast<float>(params.height_min), static_cast<float>(params.height_max));
  if (frame.causes.weather <= 0) {
    std::vector<char> doubted(found.height.size(), 0);
    for (std::size_t k = 0; k < found.phantom.size(); ++k)
      if (found.phantom[k] > 1 - kHardlyDoubted) doubted[found.obstacles[k]] = 1;
    const auto sure = [&](std::uint32_t i) {
      return !doubted[i] &&
             (cloud.trust.empty() || cloud.trust[found.points.source[i]] >= kHardlyDoubted);
    };
    slab.erase(std::remove_if(slab.begin(), slab.end(), sure), slab.end());
  }
  const auto shares = solidShares(cells, slab);
  found.solid.assign(found.height.size(), PlacedReturns::kFewDirections);
  for (std::size_t k = 0; k < slab.size(); ++k) found.solid[slab[k]] = shares[k];
}

/// Of phantoms at a place, from which on the tracker hears of them: a missed object would else be
/// taken for a phantom in the clearest air (assumed).
constexpr double kLikelyCause = 0.5;

/// What may make phantoms, by place in the ego frame.
CausesAt causesOf(const SensorFrame& frame) {
  if (!frame.causes.any() && frame.causes.spray <= 0) return {};
  return [&frame](const Vector2& place) {
    const Vector3 world = frame.ego.T_world_ego * Vector3(place.x(), place.y(), 0);
    return frame.causes.at(world.head<2>(), frame.stamp);
  };
}

}  // namespace

void ClassifierParams::visit(ParamVisitor& v) {
  v.path("file", file, "model of perception-calibrate lidar-classes; empty: labels by size");
}

std::vector<std::string> LidarFrontEnd::labels(const ClusterParams& clusters) {
  std::vector<std::string> names = {"car_sized", "person_sized"};
  if (clusters.accept_unstable) names.emplace_back("unstable");
  return names;
}

LidarFrontEnd::LidarFrontEnd(const LidarParams& params, const ClassTable& classes,
                             const DetectionModel& detection_model,
                             std::shared_ptr<const ClusterClassifier> classifier)
    : params_(params),
      fov_(detection_model.params().fov),
      reach_(detection_model.params().range_max),
      classes_(classes),
      classifier_(std::move(classifier)) {
  if (classifier_) {
    model_ = std::make_shared<ClusterModel>(classes, detection_model, classifier_->memory());
  } else {
    model_ = std::make_shared<FootprintModel>(classes, detection_model);
  }
}

PointParams LidarFrontEnd::pointsFor(const SensorFrame& frame) const {
  PointParams points = params_.points;
  if (!way_) return points;
  const double end = std::max(points.vehicle_front, points.vehicle_rear);
  const double sensor = frame.T_ego_sensor.translation().head<2>().norm();
  points.range_max = std::max(points.range_max, way_(frame.ego.velocity.norm()) + end + sensor);
  return points;
}

LidarDetections LidarFrontEnd::detect(const SensorFrame& frame) const {
  EgoPoints points = usablePoints(frame, pointsFor(frame));
  std::vector<float> height;
  GroundSurface surface(frame.ground, points, params_.surface, &height);
  LidarDetections found(std::move(points), std::move(height), std::move(surface));
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  if (cloud == nullptr) return found;
  const ObstacleParams& obstacles = params_.obstacles;
  splitGround(*cloud, found.points, found.height,
              {obstacles.height_min, obstacles.height_max, obstacles.min_trust}, found.ground,
              found.obstacles);
  dropUnreachable(found.points, reach_, found.obstacles);
  gatherObstacles(*cloud, found);
  std::optional<DirectionCells> cells;
  if (classifier_ || frame.causes.any()) cells.emplace(found.points);
  if (classifier_) {
    found.field = fieldOf(*cells, found.height, obstacles.height_min);
    Judgement judgement =
        judgedClusters(found, *cloud, *cells, *classifier_, causesOf(frame), reach_);
    found.judged = std::move(judgement.clusters);
    found.phantom = std::move(judgement.phantom);
    found.verdicts = std::move(judgement.verdicts);
  }
  if (frame.causes.any()) describeSolid(frame, *cloud, obstacles, *cells, found);
  if (classifier_) return found;
  found.clusters = findClusters(found.x, found.y, found.above, params_.clusters, found.trust);
  found.persons = findPersons(found.x, found.y, found.above, params_.persons, found.trust,
                              found.points.sensor.head<2>());
  settleOverlaps(found, params_.persons, params_.clusters);
  return found;
}

PlacedReturns placedReturns(EgoPoints points, std::vector<float> height, const PointParams& point,
                            const ObstacleParams& obstacle) {
  PlacedReturns returns;
  returns.x = std::move(points.x), returns.y = std::move(points.y), returns.z = std::move(points.z);
  returns.height = std::move(height);
  returns.source = std::move(points.source);
  returns.height_min = obstacle.height_min;
  returns.height_max = obstacle.height_max;
  returns.vehicle_front = point.vehicle_front, returns.vehicle_rear = point.vehicle_rear;
  return returns;
}

void LidarFrontEnd::fill(const SensorFrame& frame, MeasurementScan& scan) const {
  LidarDetections found = detect(frame);
  const ObstacleParams& obstacles = params_.obstacles;
  scan.dropped_points = found.points.dropped + found.points.capped;
  const auto occlusion =
      occlusionMapOf(found, frame.ego.T_world_ego, scan.state.T_world_sensor, obstacles);
  scan.occlusion = occlusion;

  const ScanContext context{
      frame, found, params_, scan.state.T_world_sensor, *occlusion, fov_, classifier_ != nullptr};
  const Vector2 sensor = found.points.sensor.head<2>();
  // What lies beyond the sensor's range_max has no chance of detection: it would be a new track in
  // every scan. The sensor's own place is no object.
  const auto reached = [&](const std::vector<Vector2>& hull) {
    const double range = distanceToHull(hull, sensor);
    return range > 0 && range <= reach_;
  };
  const auto add = [&scan](Measurement m) {
    m.detection = static_cast<int>(scan.measurements.size());
    scan.measurements.push_back(std::move(m));
  };
  std::optional<RadialMotion> motion;
  if (frame.before && !found.judged.empty())
    motion.emplace(*frame.before, found, frame.ego, frame.stamp);
  std::vector<std::optional<Measurement>> judged(found.judged.size());
  parallelFor(judged.size(), [&](std::size_t k) {
    const JudgedCluster& cluster = found.judged[k];
    const std::optional<MovingCluster> moving = motion ? motion->of(cluster.points) : std::nullopt;
    Cluster outline;
    outline.points = moving && moving->behindACloud() ? moving->behind_cloud : cluster.points;
    describeCluster(found.x, found.y, found.above, outline);
    if (!reached(outline.hull)) return;
    Measurement& m = judged[k].emplace(measurementOf(context, cluster, std::move(outline)));
    if (moving) m.radial_speed = moving->speed;
    if (cluster.cause > kLikelyCause)
      m.phantom = PhantomLook{cluster.cause, std::min(cluster.phantom, cluster.cause),
                              cluster.looks_phantom};
    m.log_class.reserve(classes_.classes.size());
    for (const ObjectClass& c : classes_.classes)
      m.log_class.push_back(cluster.evidence[static_cast<std::size_t>(c.shape)]);
  });
  for (std::optional<Measurement>& m : judged)
    if (m) add(std::move(*m));
  for (const Cluster& cluster : found.clusters)
    if (reached(cluster.hull)) add(measurementOf(context, cluster));
  for (const PersonPeak& peak : found.persons)
    if ((peak.center - sensor).norm() <= reach_) add(measurementOf(context, peak));
  scan.verdicts = std::move(found.verdicts);
  PlacedReturns returns =
      placedReturns(std::move(found.points), std::move(found.height), params_.points, obstacles);
  if (!found.phantom.empty()) {
    returns.phantom.assign(returns.size(), PlacedReturns::kNoCluster);
    for (std::size_t k = 0; k < found.obstacles.size(); ++k)
      returns.phantom[found.obstacles[k]] = found.phantom[k];
  }
  returns.solid = std::move(found.solid);
  scan.returns = std::make_shared<const PlacedReturns>(std::move(returns));
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
  params.car_noise = config.read(section + ".noise.car_sized", params.car_noise);
  params.person_noise = config.read(section + ".noise.person_sized", params.person_noise);
  const auto classifier = config.read<ClassifierParams>(section + ".classifier");
  if (params.clusters.accept_unstable)
    params.unstable_noise = config.read(section + ".noise.unstable", params.unstable_noise);

  DetectionParams defaults;  // holds the lidar defaults of method.md 2.3 and 5.3
  defaults.kind = "lidar";
  defaults.modality = Modality::kLidar;
  const DetectionModel detection_model = DetectionModel::read(
      config, section, classes, LidarFrontEnd::labels(params.clusters), defaults);
  std::shared_ptr<const ClusterClassifier> model;
  if (!classifier.file.empty())
    model = std::make_shared<const ClusterClassifier>(ClusterClassifier::read(classifier.file));
  return std::make_unique<LidarFrontEnd>(params, classes, detection_model, std::move(model));
}

}  // namespace perception
