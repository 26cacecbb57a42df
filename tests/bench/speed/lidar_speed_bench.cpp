// The lidar front end's steps beside the libraries that people use for them, on recorded scans: the
// same input, the answers compared in the same run, scans outer, methods inner, order rotated, CPU
// clock of one thread.
//   lidar_speed_bench [every Nth scan of the 100 of the front view, default 10]
#include <fmt/format.h>
#include <pcl/ModelCoefficients.h>
#include <pcl/sample_consensus/method_types.h>
#include <pcl/sample_consensus/model_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/sac_segmentation.h>

#include <cstdlib>
#include <limits>
#include <map>
#include <nanoflann.hpp>
#include <opencv2/imgproc.hpp>

#include "libperception/lidar/LidarFrontEnd.h"
#include "libperception/lidar/ground/GroundPlane.h"
#include "libperception/lidar/ground/SplitGround.h"
#include "libperception/lidar/two_spacings/PersonResponse.h"
#include "tests/bench/speed/LidarScans.h"
#include "tests/lidar/linkage/FarPartition.h"

namespace perception::bench {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

/// Times of several methods on the same inputs; the first is ours.
class Paired {
 public:
  Paired(std::string title, std::vector<std::string> methods)
      : title_(std::move(title)), methods_(std::move(methods)), ms_(methods_.size()) {}

  /// Runs f(method) for every method, another one first each time.
  template <class Function>
  void run(const Function& f) {
    for (std::size_t k = 0; k < methods_.size(); ++k) {
      const std::size_t method = (k + round_) % methods_.size();
      const double begin = cpuSeconds();
      f(method);
      ms_[method].push_back(1e3 * (cpuSeconds() - begin));
    }
    ++round_;
  }

  void print() const {
    fmt::print("{} ({} scans)\n", title_, round_);
    for (std::size_t m = 0; m < methods_.size(); ++m) {
      std::vector<double> ratio;
      for (std::size_t i = 0; i < round_; ++i) ratio.push_back(ms_[m][i] / ms_[0][i]);
      fmt::print("  {:<34} {:>9.2f} ms p50 {:>9.2f} ms p99", methods_[m], quantile(ms_[m], 0.5),
                 quantile(ms_[m], 0.99));
      if (m > 0)
        fmt::print("   ratio to ours: p50 {:>7.1f}  p01 {:>7.1f}", quantile(ratio, 0.5),
                   quantile(ratio, 0.01));
      fmt::print("\n");
    }
  }

 private:
  std::string title_;
  std::vector<std::string> methods_;
  std::vector<std::vector<double>> ms_;
  std::size_t round_ = 0;
};

struct Faults {
  int count = 0;
  void check(bool holds, const std::string& what) {
    if (holds) return;
    ++count;
    fmt::print("  FAULT: {}\n", what);
  }
};

LidarFrontEnd frontEnd() {
  LidarParams params;
  params.points.vehicle_front = 2.4, params.points.vehicle_rear = 2.6;
  ClassTable classes;
  classes.classes.resize(1);
  return LidarFrontEnd(params, classes,
                       DetectionModel(DetectionParams{}, {ClassDetection{}},
                                      LidarFrontEnd::labels(params.clusters)));
}

// ---- ground ---------------------------------------------------------------------------------

Cloud::Ptr toPcl(const LidarCloud& cloud) {
  Cloud::Ptr out(new Cloud);
  out->reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
    out->push_back(pcl::PointXYZ(cloud.x[i], cloud.y[i], cloud.z[i]));
  return out;
}

/// Ground by a RANSAC plane as PCL's tutorial has it: inlier distance 0.2 m, refined.
std::vector<std::uint8_t> groundByPcl(const Cloud::Ptr& cloud, pcl::ModelCoefficients& plane) {
  pcl::SACSegmentation<pcl::PointXYZ> segmentation;
  segmentation.setOptimizeCoefficients(true);
  segmentation.setModelType(pcl::SACMODEL_PLANE);
  segmentation.setMethodType(pcl::SAC_RANSAC);
  segmentation.setMaxIterations(200);  // as ours
  segmentation.setDistanceThreshold(0.2);
  segmentation.setInputCloud(cloud);
  pcl::PointIndices inliers;
  segmentation.segment(inliers, plane);
  std::vector<std::uint8_t> ground(cloud->size(), 0);
  for (const int i : inliers.indices) ground[static_cast<std::size_t>(i)] = 1;
  return ground;
}

/// Plane, local surface and a label per return of the cloud.
std::vector<std::uint8_t> groundByUs(const SensorFrame& frame, const LidarParams& params,
                                     GroundPlane& plane) {
  GroundEstimator estimator;
  plane = estimator.update(frame);
  const EgoPoints points = usablePoints(frame, params.points);
  std::vector<float> heights;
  const GroundSurface surface(plane, points, params.surface, &heights);
  std::vector<std::uint8_t> ground;
  labelGround(points, heights, static_cast<float>(params.obstacles.height_min),
              std::get<LidarCloud>(frame.data).size(), ground);
  return ground;
}

void compareGround(const std::vector<RecordedScan>& scans, const LidarParams& params,
                   Faults& faults) {
  Paired times("Ground, " + scans.front().set, {"ours, plane + surface + labels", "PCL RANSAC"});
  std::vector<double> overlap, height_difference;
  for (const RecordedScan& scan : scans) {
    const Cloud::Ptr cloud = toPcl(std::get<LidarCloud>(scan.frame.data));
    std::vector<std::uint8_t> ours, theirs;
    GroundPlane plane;
    pcl::ModelCoefficients other;
    times.run([&](std::size_t method) {
      if (method == 0) {
        ours = groundByUs(scan.frame, params, plane);
      } else {
        theirs = groundByPcl(cloud, other);
      }
    });
    std::size_t both = 0, any = 0;
    for (std::size_t i = 0; i < ours.size(); ++i) {
      both += ours[i] & theirs[i];
      any += ours[i] | theirs[i];
    }
    overlap.push_back(static_cast<double>(both) / static_cast<double>(any));
    const auto& v = other.values;
    const double theirs_ahead = -static_cast<double>(v[0] * 10 + v[3]) / static_cast<double>(v[2]) +
                                scan.frame.T_ego_sensor.translation().z();
    height_difference.push_back(std::abs(theirs_ahead - plane.heightAt(10, 0)));
    faults.check(plane.measured, fmt::format("scan {}: no plane", scan.number));
  }
  times.print();
  fmt::print(
      "  labels: intersection over union p50 {:.3f}; planes 10 m ahead differ by p50 {:.3f} m\n",
      quantile(overlap, 0.5), quantile(height_difference, 0.5));
  faults.check(quantile(overlap, 0.5) > 0.7 && quantile(height_difference, 0.5) < 0.1,
               "the two do not see the same ground");
}

// ---- clusters -------------------------------------------------------------------------------

/// Just beyond the threshold, since PCL takes "below" for "within" and squares in floats.
double inclusive(double threshold) {
  return static_cast<double>(std::nextafter(static_cast<float>(threshold), 1e9f));
}

/// Groups numbered in the order of their first points.
std::vector<std::uint32_t> inOrder(const std::vector<std::uint32_t>& group) {
  std::map<std::uint32_t, std::uint32_t> number;
  std::vector<std::uint32_t> out;
  for (const std::uint32_t g : group)
    out.push_back(number.emplace(g, static_cast<std::uint32_t>(number.size())).first->second);
  return out;
}

std::vector<std::uint32_t> clustersByPcl(const Cloud::Ptr& cloud, double threshold) {
  pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
  tree->setInputCloud(cloud);
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setClusterTolerance(inclusive(threshold));
  extraction.setMinClusterSize(1);
  extraction.setMaxClusterSize(std::numeric_limits<int>::max());
  extraction.setSearchMethod(tree);
  extraction.setInputCloud(cloud);
  std::vector<pcl::PointIndices> found;
  extraction.extract(found);
  std::vector<std::uint32_t> group(cloud->size(), 0);
  for (std::size_t g = 0; g < found.size(); ++g)
    for (const int i : found[g].indices)
      group[static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(g);
  return group;
}

/// The plane's points as nanoflann wants them.
struct PlanePoints {
  const std::vector<float>&x, &y;
  std::size_t kdtree_get_point_count() const { return x.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return axis == 0 ? x[i] : y[i]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

std::vector<std::uint32_t> clustersByNanoflann(const std::vector<float>& x,
                                               const std::vector<float>& y, double threshold) {
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, PlanePoints>,
                                                   PlanePoints, 2, std::uint32_t>;
  const PlanePoints points{x, y};
  const Tree tree(2, points, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> group(x.size(), kNone), queue;
  const auto t2 = static_cast<float>(threshold * threshold);
  nanoflann::SearchParams search;
  search.sorted = false;
  std::vector<std::pair<std::uint32_t, float>> near;
  std::uint32_t count = 0;
  for (std::uint32_t seed = 0; seed < x.size(); ++seed) {
    if (group[seed] != kNone) continue;
    group[seed] = count;
    queue.assign(1, seed);
    while (!queue.empty()) {
      const std::uint32_t i = queue.back();
      queue.pop_back();
      const float query[2] = {x[i], y[i]};
      near.clear();
      tree.radiusSearch(query, std::nextafter(t2, 2 * t2), near, search);
      for (const auto& [j, distance2] : near)
        if (group[j] == kNone) group[j] = count, queue.push_back(j);
    }
    ++count;
  }
  return group;
}

void compareClusters(const std::vector<RecordedScan>& scans, const LidarFrontEnd& lidar,
                     Faults& faults) {
  Paired times("Clusters at 0.5 and 1.0 m, " + scans.front().set,
               {"ours, both thresholds", "PCL EuclideanClusterExtraction, both",
                "nanoflann region growing, 0.5 m"});
  std::size_t returns = 0, identical = 0;
  for (const RecordedScan& scan : scans) {
    SensorFrame frame = scan.frame;
    frame.ground = GroundEstimator().update(frame);
    const LidarDetections found = lidar.detect(frame);
    returns += found.x.size();
    Cloud::Ptr cloud(new Cloud);
    for (std::size_t i = 0; i < found.x.size(); ++i)
      cloud->push_back(pcl::PointXYZ(found.x[i], found.y[i], 0));
    DoubleLinkage ours;
    std::vector<std::uint32_t> near, far, flann;
    times.run([&](std::size_t method) {
      if (method == 0) ours = linkTwice(found.x, found.y, 0.5, 1.0);
      if (method == 1) near = clustersByPcl(cloud, 0.5), far = clustersByPcl(cloud, 1.0);
      if (method == 2) flann = clustersByNanoflann(found.x, found.y, 0.5);
    });
    const auto groups = [](const std::vector<std::uint32_t>& g) {
      return g.empty() ? 0 : 1 + *std::max_element(g.begin(), g.end());
    };
    const bool same = inOrder(near) == ours.near.group && inOrder(flann) == ours.near.group &&
                      inOrder(far) == test::farPartition(ours).group;
    identical += same;
    faults.check(same, fmt::format("scan {}: {} and {} groups, PCL {} and {}, nanoflann {}",
                                   scan.number, ours.near.count, ours.far_count, groups(near),
                                   groups(far), groups(flann)));
  }
  times.print();
  fmt::print("  {} obstacle returns a scan; partitions identical on {} of {} scans\n",
             returns / scans.size(), identical, scans.size());
}

// ---- persons --------------------------------------------------------------------------------

/// Literal filter and literal maximum of the eight neighbors. Both methods count the returns in
/// cells first.
void personsByOpenCv(const LidarDetections& found, const PersonResponse& grid,
                     const cv::Mat& kernel, cv::Mat& counts, cv::Mat& response, cv::Mat& highest) {
  counts.create(static_cast<int>(grid.rows()), static_cast<int>(grid.columns()), CV_32F);
  counts.setTo(0);
  const Vector2 first = grid.center(0);
  const double per_meter = 1 / grid.cell();
  const double x0 = first.x() - grid.cell() / 2, y0 = first.y() - grid.cell() / 2;
  for (std::size_t i = 0; i < found.x.size(); ++i)
    counts.at<float>(static_cast<int>((static_cast<double>(found.y[i]) - y0) * per_meter),
                     static_cast<int>((static_cast<double>(found.x[i]) - x0) * per_meter)) += 1;
  cv::filter2D(counts, response, CV_32F, kernel, cv::Point(-1, -1), 0, cv::BORDER_CONSTANT);
  cv::dilate(response, highest, cv::Mat::ones(3, 3, CV_8U));
}

cv::Mat kernelOf(const PersonParams& params) {
  const int reach = static_cast<int>(params.support / params.cell);
  cv::Mat kernel(2 * reach + 1, 2 * reach + 1, CV_32F, cv::Scalar(0));
  for (int row = -reach; row <= reach; ++row)
    for (int column = -reach; column <= reach; ++column) {
      const double r = std::hypot(row, column) * params.cell;
      if (r <= params.support)
        kernel.at<float>(row + reach, column + reach) = static_cast<float>(personKernel(r, params));
    }
  return kernel;
}

void comparePersons(const std::vector<RecordedScan>& scans, const LidarFrontEnd& lidar,
                    Faults& faults) {
  Paired times("Person filter at 0.25 m with maxima, " + scans.front().set,
               {"ours", "OpenCV filter2D + dilate"});
  const PersonParams params;
  const cv::Mat kernel = kernelOf(params);
  constexpr float kLeast = 3.6f;  // threshold x min_points
  double worst = 0;
  std::size_t cells = 0;
  for (const RecordedScan& scan : scans) {
    SensorFrame frame = scan.frame;
    frame.ground = GroundEstimator().update(frame);
    const LidarDetections found = lidar.detect(frame);
    const PersonResponse grid(found.x, found.y, {}, params);
    cells += grid.values().size();
    const int columns = static_cast<int>(grid.columns());
    std::vector<std::uint32_t> ours;
    cv::Mat counts, response, highest;
    times.run([&](std::size_t method) {
      if (method == 0) {
        const PersonResponse own(found.x, found.y, {}, params);
        ours = own.maxima(kLeast);
      } else {
        personsByOpenCv(found, grid, kernel, counts, response, highest);
      }
    });
    for (std::size_t k = 0; k < grid.values().size(); ++k) {
      const float theirs = response.ptr<float>()[k];
      worst = std::max(worst, static_cast<double>(std::abs(theirs - grid.values()[k])) /
                                  (1 + std::abs(static_cast<double>(theirs))));
    }
    for (const std::uint32_t k : ours)
      faults.check(highest.ptr<float>()[k] <= response.ptr<float>()[k] * 1.0001f,
                   fmt::format("scan {}: a maximum that is none", scan.number));
    // Last digits decide between cells that are nearly equal: a clear maximum must be ours, too.
    for (std::size_t k = 0; k < grid.values().size(); ++k) {
      const int row = static_cast<int>(k) / columns, column = static_cast<int>(k) % columns;
      const float here = response.at<float>(row, column);
      if (here < kLeast * 1.001f || here < highest.at<float>(row, column)) continue;
      bool beside = false, clear = true;
      for (int r = row - 1; r <= row + 1; ++r)
        for (int c = column - 1; c <= column + 1; ++c) {
          beside |= counts.at<float>(r, c) > 0;
          clear &= (r == row && c == column) || response.at<float>(r, c) < here * 0.999f;
        }
      faults.check(!beside || !clear ||
                       std::binary_search(ours.begin(), ours.end(), static_cast<std::uint32_t>(k)),
                   fmt::format("scan {}: a maximum is missing", scan.number));
    }
  }
  times.print();
  fmt::print("  {} cells a scan; largest relative difference of a response {:.1e}\n",
             cells / scans.size(), worst);
  faults.check(worst < 1e-3, "responses differ");
}

/// What the front end costs as a whole, and where.
void profile(const std::vector<RecordedScan>& scans, const LidarFrontEnd& lidar) {
  std::vector<double> ground, points, surface, clusters, persons, all;
  GroundEstimator estimator;
  const LidarParams& params = lidar.params();
  const auto since = [](double begin) { return 1e3 * (cpuSeconds() - begin); };
  std::size_t returns = 0;
  for (const RecordedScan& scan : scans) {
    SensorFrame frame = scan.frame;
    returns += std::get<LidarCloud>(frame.data).size();
    double begin = cpuSeconds();
    frame.ground = estimator.update(frame);
    ground.push_back(since(begin));
    begin = cpuSeconds();
    const MeasurementScan measured = lidar.extract(frame);
    all.push_back(since(begin));
    const LidarDetections found = lidar.detect(frame);
    begin = cpuSeconds();
    const EgoPoints usable = usablePoints(frame, params.points);
    points.push_back(since(begin));
    begin = cpuSeconds();
    std::vector<float> heights;
    const GroundSurface local(frame.ground, usable, params.surface, &heights);
    surface.push_back(since(begin));
    begin = cpuSeconds();
    findClusters(found.x, found.y, found.above, params.clusters);
    clusters.push_back(since(begin));
    begin = cpuSeconds();
    findPersons(found.x, found.y, found.above, params.persons);
    persons.push_back(since(begin));
  }
  fmt::print("{:<20} {:>8} {:>7.2f} {:>7.2f} {:>8.2f} {:>9.2f} {:>8.2f} | {:>7.2f} {:>7.2f}\n",
             scans.front().set, returns / scans.size(), quantile(ground, 0.5),
             quantile(points, 0.5), quantile(surface, 0.5), quantile(clusters, 0.5),
             quantile(persons, 0.5), quantile(all, 0.5), quantile(all, 0.99));
}

}  // namespace
}  // namespace perception::bench

int main(int argc, char** argv) {
  using namespace perception::bench;
  cv::setNumThreads(1);
  const auto full = kittiFull(), front = kittiFront(), snow = wads();
  if (full.empty() || front.empty() || snow.empty()) {
    fmt::print("skipped: no recordings in {}\n", recording(""));
    return 0;
  }
  const std::size_t every = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 10;
  std::vector<RecordedScan> some, few;
  for (std::size_t i = 0; i < front.size(); i += std::max<std::size_t>(every, 1))
    some.push_back(front[i]);
  for (std::size_t i = 0; i < snow.size(); i += 5) few.push_back(snow[i]);
  const perception::LidarFrontEnd lidar = frontEnd();
  Faults faults;
  fmt::print(
      "The front end as a whole, ms p50\n{:<20} {:>8} {:>7} {:>7} {:>8} {:>9} {:>8} | {:>7} "
      "{:>7}\n",
      "", "returns", "plane", "points", "surface", "clusters", "persons", "extract", "p99");
  for (const auto* scans : {&full, &front, &snow}) profile(*scans, lidar);
  for (const auto* scans : {&full, &front}) compareGround(*scans, lidar.params(), faults);
  for (const auto* scans : {&full, &front}) comparePersons(*scans, lidar, faults);
  for (const std::vector<RecordedScan>& scans : {full, some, few})
    compareClusters(scans, lidar, faults);
  fmt::print(faults.count == 0 ? "same answers\n" : "{} faults\n", faults.count);
  return faults.count == 0 ? 0 : 1;
}
