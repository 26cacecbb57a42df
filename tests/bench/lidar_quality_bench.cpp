// What the lidar rib gets right on real recordings with labels: ground per return in falling snow
// (WADS) beside PCL's RANSAC, and recall and precision of the detections, by size and by class, on
// KITTI tracking 0000 and WADS, with what the false ones are.
#include <fmt/format.h>
#include <pcl/ModelCoefficients.h>
#include <pcl/sample_consensus/method_types.h>
#include <pcl/sample_consensus/model_types.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <array>
#include <map>

#include "libperception/app/KittiFiles.h"
#include "libperception/lidar/BoxFit.h"
#include "libperception/lidar/GroundPlane.h"
#include "libperception/lidar/LidarFrontEnd.h"
#include "tests/bench/LidarScans.h"

namespace perception::bench {
namespace {

// Classes of WADS.
constexpr std::uint16_t kUnlabelled = 0, kCar = 10, kOtherVehicle = 20, kPerson = 30, kRoad = 40,
                        kFallingSnow = 110, kLyingSnow = 111;
const std::map<std::uint16_t, const char*> kNames = {
    {0, "unlabelled"}, {10, "car"},          {20, "other vehicle"}, {30, "person"},
    {40, "road"},      {50, "building"},     {70, "vegetation"},    {80, "pole"},
    {81, "sign"},      {99, "other object"}, {110, "falling snow"}, {111, "lying snow"}};

LidarFrontEnd frontEnd(const LidarParams& params) {
  ClassTable classes;
  classes.classes.resize(1);
  return LidarFrontEnd(
      params, classes,
      Sensing(SensingParams{}, {ClassSensing{}}, LidarFrontEnd::labels(params.clusters)));
}

// ---- ground ---------------------------------------------------------------------------------

/// Returns labelled ground or not against what was said.
struct GroundScore {
  std::size_t hit = 0, missed = 0, wrong = 0;
  void add(std::uint16_t label, bool said) {
    if (label == kUnlabelled || label == kFallingSnow) return;
    const bool truth = label == kRoad || label == kLyingSnow;
    hit += truth && said, missed += truth && !said, wrong += !truth && said;
  }
  double precision() const { return ratio(hit, hit + wrong); }
  double recall() const { return ratio(hit, hit + missed); }
  double f1() const { return ratio(2 * hit, 2 * hit + missed + wrong); }
  static double ratio(std::size_t a, std::size_t b) {
    return b == 0 ? 0 : static_cast<double>(a) / static_cast<double>(b);
  }
  void print(const char* name) const {
    fmt::print("  {:<34} precision {:.3f}  recall {:.3f}  F1 {:.3f}\n", name, precision(), recall(),
               f1());
  }
};

/// PCL's best plane within `tolerance`, returns within `label_tolerance` of it are ground.
std::vector<std::uint8_t> groundByPcl(const LidarCloud& points, double tolerance,
                                      double label_tolerance) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  for (std::size_t i = 0; i < points.size(); ++i)
    cloud->push_back(pcl::PointXYZ(points.x[i], points.y[i], points.z[i]));
  pcl::SACSegmentation<pcl::PointXYZ> segmentation;
  segmentation.setOptimizeCoefficients(true);
  segmentation.setModelType(pcl::SACMODEL_PLANE);
  segmentation.setMethodType(pcl::SAC_RANSAC);
  segmentation.setMaxIterations(200);
  segmentation.setDistanceThreshold(tolerance);
  segmentation.setInputCloud(cloud);
  pcl::PointIndices inliers;
  pcl::ModelCoefficients plane;
  segmentation.segment(inliers, plane);
  std::vector<std::uint8_t> ground(points.size(), 0);
  if (plane.values.size() != 4) return ground;
  const auto& v = plane.values;
  for (std::size_t i = 0; i < points.size(); ++i)
    ground[i] = std::abs(v[0] * points.x[i] + v[1] * points.y[i] + v[2] * points.z[i] + v[3]) <=
                static_cast<float>(label_tolerance);
  return ground;
}

void scoreGround(const std::vector<RecordedScan>& scans, const LidarFrontEnd& lidar) {
  GroundScore ours, plane_alone, tight, wide;
  std::map<std::uint16_t, std::size_t> wrong;
  GroundEstimator estimator;
  LidarParams flat = lidar.params();
  flat.surface.local = false;
  const LidarFrontEnd without_surface = frontEnd(flat);
  const double far = lidar.params().points.range_max;
  for (const RecordedScan& scan : scans) {
    SensorFrame frame = scan.frame;
    frame.ground = estimator.update(frame);
    const auto& cloud = std::get<LidarCloud>(frame.data);
    const auto found = lidar.detect(frame), plane = without_surface.detect(frame);
    const auto narrow = groundByPcl(cloud, 0.2, 0.2), broad = groundByPcl(cloud, 0.3, 0.3);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      // All methods are judged where ours says something.
      if (std::hypot(cloud.x[i], cloud.y[i]) > static_cast<float>(far)) continue;
      const std::uint16_t label = scan.point_class[i];
      ours.add(label, found.ground[i] != 0), plane_alone.add(label, plane.ground[i] != 0);
      tight.add(label, narrow[i] != 0), wide.add(label, broad[i] != 0);
      if (label != kRoad && label != kLyingSnow && found.ground[i]) ++wrong[label];
    }
  }
  fmt::print("Ground per return, {} ({} scans, to {} m; road and lying snow are ground)\n",
             scans.front().set, scans.size(), far);
  ours.print("ours");
  plane_alone.print("ours, plane alone");
  tight.print("PCL RANSAC, 0.2 m");
  wide.print("PCL RANSAC, 0.3 m");
  fmt::print("  taken for ground:");
  for (const auto& [label, count] : wrong)
    if (label != kUnlabelled && label != kFallingSnow)
      fmt::print(" {} {}", kNames.count(label) ? kNames.at(label) : "?", count);
  fmt::print("\n");
}

// ---- detections -----------------------------------------------------------------------------

/// Counts of one table row.
struct Score {
  std::size_t truths = 0, seen = 0;                       ///< recall
  std::size_t detections = 0, of_size = 0, of_class = 0;  ///< precision
};

std::string share(std::size_t a, std::size_t b) {
  return b == 0 ? "n/a"
                : fmt::format("{:.0f} % ({}/{})",
                              100.0 * static_cast<double>(a) / static_cast<double>(b), a, b);
}

void printScore(const char* name, const Score& s, const char* paper) {
  fmt::print("  {:<26} recall {:<18} precision: size {:<20} class {:<20} paper {}\n", name,
             share(s.seen, s.truths), share(s.of_size, s.detections),
             share(s.of_class, s.detections), paper);
}

bool isVehicle(const std::string& type) {
  return type == "Car" || type == "Van" || type == "Truck" || type == "Tram";
}
bool isPerson(const std::string& type) {
  return type == "Pedestrian" || type == "Person" || type == "Person_sitting";
}

struct Truth {
  std::string type;
  std::vector<Vector2> corners;  ///< [m] ego frame
  bool counts = false;
};

/// Labelled objects of a frame, hit by enough returns.
std::vector<Truth> truthsOf(const std::vector<KittiLabel>& labels, std::int64_t frame,
                            const KittiCalibration& calibration, const LidarCloud& cloud,
                            double range) {
  std::vector<Truth> truths;
  for (const KittiLabel& label : labels) {
    if (label.frame != frame || !label.box || label.type == "DontCare") continue;
    const auto box = boxInVelodyne(*label.box, calibration);
    Truth truth;
    truth.type = label.type;
    for (const Vector2& sign : {Vector2(1, 1), Vector2(-1, 1), Vector2(-1, -1), Vector2(1, -1)})
      truth.corners.push_back(
          box.bottom_centre.head<2>() +
          rotate2(box.yaw, {sign.x() * box.length / 2, sign.y() * box.width / 2}));
    truth.counts = label.occluded <= 2 && box.bottom_centre.head<2>().norm() <= range &&
                   returnsInside(*label.box, cloud, calibration) >= 20;
    truths.push_back(std::move(truth));
  }
  return truths;
}

constexpr double kNear = 0.75;  // [m] from a detection's middle to the outline of its object

void scoreKitti(const std::vector<RecordedScan>& scans, const LidarFrontEnd& lidar, double range) {
  const std::string set = recording("kitti_tracking/");
  const auto labels = readKittiLabels(set + "label_02/0000.txt");
  const auto calibration = readKittiCalibration(set + "calib/0000.txt");
  Score cars, stable, persons;
  std::size_t riders = 0, riders_seen = 0;
  GroundEstimator estimator;
  for (const RecordedScan& scan : scans) {
    SensorFrame frame = scan.frame;
    frame.ground = estimator.update(frame);
    const MeasurementScan found = lidar.extract(frame);
    const auto truths =
        truthsOf(labels, scan.number, calibration, std::get<LidarCloud>(frame.data), range);
    const auto near = [](const Measurement& m, const Truth& truth) {
      return distanceToHull(truth.corners, m.position) <= kNear;
    };
    for (const Truth& truth : truths) {
      if (!truth.counts) continue;
      bool any = false, as_stable = false, as_person = false;
      for (const Measurement& m : found.measurements) {
        if (!near(m, truth)) continue;
        any = true, as_stable |= m.label == 0, as_person |= m.label == 1;
      }
      if (isVehicle(truth.type)) {
        ++cars.truths, ++stable.truths;
        cars.seen += any, stable.seen += as_stable;
      } else if (isPerson(truth.type)) {
        ++persons.truths, persons.seen += as_person;
      } else {
        ++riders, riders_seen += any;
      }
    }
    for (const Measurement& m : found.measurements) {
      // Labels cover the camera's view alone.
      if (m.position.norm() > range ||
          std::abs(std::atan2(m.position.y(), m.position.x())) > radians(38))
        continue;
      bool vehicle = false, person = false, rider = false;
      for (const Truth& truth : truths) {
        if (!near(m, truth)) continue;
        vehicle |= isVehicle(truth.type), person |= isPerson(truth.type);
        rider |= truth.type == "Cyclist";
      }
      if (m.label == 1) {
        ++persons.detections, persons.of_class += person, persons.of_size += person || rider;
      } else {
        ++cars.detections, cars.of_class += vehicle, cars.of_size += vehicle || rider;
        if (m.label == 0)
          ++stable.detections, stable.of_class += vehicle, stable.of_size += vehicle || rider;
      }
    }
  }
  fmt::print("Detections, {} ({} scans, to {} m, objects with 20 returns)\n", scans.front().set,
             scans.size(), range);
  printScore("car-sized, the paper's rule", stable, "91 / 51");
  printScore("car-sized, with unstable", cars, "91 / 51");
  printScore("person-sized", persons, "88 / 55");
  fmt::print("  cyclists seen at all: {}; size: of the class, or a rider\n",
             share(riders_seen, riders));
}

/// Objects of WADS: groups of returns of one class, 0.7 m apart at most. No boxes, no ids.
std::vector<Cluster> objectsOf(const RecordedScan& scan, std::initializer_list<std::uint16_t> kinds,
                               double range, std::size_t least) {
  std::vector<float> x, y, height;
  const auto& cloud = std::get<LidarCloud>(scan.frame.data);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (std::find(kinds.begin(), kinds.end(), scan.point_class[i]) != kinds.end() &&
        std::hypot(cloud.x[i], cloud.y[i]) <= static_cast<float>(range))
      x.push_back(cloud.x[i]), y.push_back(cloud.y[i]), height.push_back(1.5f);
  ClusterParams params;
  params.near_threshold = 0.7, params.far_threshold = 0.71, params.min_top = 0;
  params.min_points = static_cast<int>(least);
  params.min_side = 0.01, params.unstable_min_side = 0.01;
  params.max_size = params.unstable_max_size = 100;
  return findClusters(x, y, height, params);
}

void scoreWads(const std::vector<RecordedScan>& scans, const LidarFrontEnd& lidar, double range) {
  Score cars, stable, persons;
  std::map<std::string, std::size_t> false_cars, false_persons;
  GroundEstimator estimator;
  for (const RecordedScan& scan : scans) {
    SensorFrame frame = scan.frame;
    frame.ground = estimator.update(frame);
    const LidarDetections found = lidar.detect(frame);
    // The class that most returns of a detection have; the share of the wanted ones.
    const auto classOf = [&](const std::vector<std::uint32_t>& returns) {
      std::map<std::uint16_t, std::size_t> votes;
      for (const std::uint32_t i : returns)
        ++votes[scan.point_class[found.points.source[found.obstacles[i]]]];
      return std::max_element(votes.begin(), votes.end(),
                              [](const auto& a, const auto& b) { return a.second < b.second; })
          ->first;
    };
    const auto touches = [](const Cluster& object, const Vector2& place) {
      return distanceToHull(object.hull, place) <= kNear;
    };
    for (const Cluster& object : objectsOf(scan, {kCar, kOtherVehicle}, range, 20)) {
      bool any = false, as_stable = false;
      for (const Cluster& c : found.clusters)
        if (touches(object, c.centroid)) any = true, as_stable |= c.stable;
      ++cars.truths, ++stable.truths, cars.seen += any, stable.seen += as_stable;
    }
    for (const Cluster& object : objectsOf(scan, {kPerson}, range, 20)) {
      bool any = false;
      for (const PersonPeak& p : found.persons) any |= touches(object, p.centre);
      ++persons.truths, persons.seen += any;
    }
    for (const Cluster& c : found.clusters) {
      if (c.centroid.norm() > range) continue;
      const std::uint16_t kind = classOf(c.points);
      const bool vehicle = kind == kCar || kind == kOtherVehicle;
      const double longest = sizeOf(c.hull).longest;
      const bool of_size = vehicle || (longest >= 2.5 && longest <= 8 && c.highest <= 2.6f);
      ++cars.detections, cars.of_class += vehicle, cars.of_size += of_size;
      if (c.stable) ++stable.detections, stable.of_class += vehicle, stable.of_size += of_size;
      if (!vehicle) ++false_cars[kNames.count(kind) ? kNames.at(kind) : "?"];
    }
    for (const PersonPeak& p : found.persons) {
      if (p.centre.norm() > range) continue;
      const std::uint16_t kind = classOf(p.points);
      ++persons.detections, persons.of_class += kind == kPerson;
      persons.of_size += kind == kPerson || p.highest - p.lowest >= 1.0f;
      if (kind != kPerson) ++false_persons[kNames.count(kind) ? kNames.at(kind) : "?"];
    }
  }
  fmt::print("Detections, {} ({} scans, to {} m, objects with 20 returns)\n", scans.front().set,
             scans.size(), range);
  printScore("car-sized, the paper's rule", stable, "91 / 51 (sunny)");
  printScore("car-sized, with unstable", cars, "91 / 51 (sunny)");
  printScore("person-sized", persons, "88 / 55 (sunny)");
  fmt::print(
      "  size: of the class, or 2.5 to 8 m long and up to 2.6 m high; 1 m of returns high\n");
  const auto list = [](const char* name, const std::map<std::string, std::size_t>& kinds) {
    fmt::print("  {}:", name);
    for (const auto& [kind, count] : kinds) fmt::print(" {} {}", kind, count);
    fmt::print("\n");
  };
  list("car-sized, but", false_cars);
  list("person-sized, but", false_persons);
}

}  // namespace
}  // namespace perception::bench

int main() {
  using namespace perception::bench;
  const auto full = kittiFull(), front = kittiFront(), snow = wads();
  if (full.empty() || front.empty() || snow.empty()) {
    fmt::print("skipped: no recordings in {}\n", recording(""));
    return 0;
  }
  perception::LidarParams kitti, wads_params;
  kitti.points.vehicle_front = 2.4, kitti.points.vehicle_rear = 2.6;
  wads_params.points.vehicle_front = 2.6, wads_params.points.vehicle_rear = 2.6;
  const auto lidar = frontEnd(kitti), snowy = frontEnd(wads_params);
  scoreGround(snow, snowy);
  scoreKitti(front, lidar, 70);
  scoreKitti(front, lidar, 20);
  scoreWads(snow, snowy, 50);
  scoreWads(snow, snowy, 20);
  return 0;
}
