// What the lidar front end gets right on real recordings with labels: ground per return in falling
// snow (WADS) beside PCL's RANSAC. Detections: detection_study.
#include <fmt/format.h>
#include <pcl/ModelCoefficients.h>
#include <pcl/sample_consensus/method_types.h>
#include <pcl/sample_consensus/model_types.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <array>
#include <map>

#include "libperception/lidar/LidarFrontEnd.h"
#include "libperception/lidar/ground/GroundPlane.h"
#include "tests/bench/speed/LidarScans.h"

namespace perception::bench {
namespace {

// Classes of WADS.
constexpr std::uint16_t kUnlabeled = 0, kRoad = 40, kFallingSnow = 110, kLyingSnow = 111;
const std::map<std::uint16_t, const char*> kNames = {
    {0, "unlabeled"}, {10, "car"},          {20, "other vehicle"}, {30, "person"},
    {40, "road"},     {50, "building"},     {70, "vegetation"},    {80, "pole"},
    {81, "sign"},     {99, "other object"}, {110, "falling snow"}, {111, "lying snow"}};

// ---- ground ---------------------------------------------------------------------------------

/// Returns labeled ground or not against what was said.
struct GroundScore {
  std::size_t hit = 0, missed = 0, wrong = 0;
  void add(std::uint16_t label, bool said) {
    if (label == kUnlabeled || label == kFallingSnow) return;
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
    if (label != kUnlabeled && label != kFallingSnow)
      fmt::print(" {} {}", kNames.count(label) ? kNames.at(label) : "?", count);
  fmt::print("\n");
}

}  // namespace
}  // namespace perception::bench

int main() {
  using namespace perception::bench;
  const auto snow = wads();
  if (snow.empty()) {
    fmt::print("skipped: no recordings in {}\n", recording(""));
    return 0;
  }
  perception::LidarParams params;
  params.points.vehicle_front = params.points.vehicle_rear = 2.6;  // [m]
  scoreGround(snow, frontEnd(params));
  return 0;
}
