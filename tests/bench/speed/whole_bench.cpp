// A whole run beside what people put together from libraries: PCL's voxel grid, ground by RANSAC
// and Euclidean clusters (the settings of its tutorials where they fit a road), and a tracker of
// Eigen Kalman filters at constant velocity with gated nearest neighbors. Both get the same decoded
// lidar scans in the same run, one after the other; one thread, CPU clock. The peer tells no class,
// no weather and no free way, and its clusters have no shape.
//   whole_bench INI LOG [SENSORS, default L] [INI LOG SENSORS ...]
// Without arguments: the embedded simulated log. Ends with 1 where the two do not see the same.
#include <fmt/format.h>
#include <pcl/ModelCoefficients.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/sac_segmentation.h>
#include <tbb/global_control.h>

#include <Eigen/Dense>
#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libperception/pipeline/Pipeline.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "tests/bench/speed/CpuClock.h"

namespace perception::bench {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using test::cpuSeconds;

/// CPU time [s] by stage, in order of first use.
class Costs {
 public:
  template <class Function>
  auto of(const std::string& stage, const Function& f) {
    const double begin = cpuSeconds();
    auto result = f();
    add(stage, cpuSeconds() - begin);
    return result;
  }
  void add(const std::string& stage, double seconds) {
    if (!seconds_.count(stage)) order_.push_back(stage);
    seconds_[stage] += seconds;
  }
  double all() const {
    double sum = 0;
    for (const auto& [stage, seconds] : seconds_) sum += seconds;
    return sum;
  }
  double of(const std::string& stage) const { return seconds_.at(stage); }
  const std::vector<std::string>& stages() const { return order_; }

 private:
  std::map<std::string, double> seconds_;
  std::vector<std::string> order_;
};

/// Position and velocity at constant velocity, with accelerations of 3 m/s^2 and a standard
/// deviation of 0.3 m of the measured place.
struct PeerTrack {
  Eigen::Vector4d state;
  Eigen::Matrix4d covariance = Eigen::Vector4d(0.1, 0.1, 100, 100).asDiagonal();
  int misses = 0, hits = 1;

  void predict(double dt) {
    Eigen::Matrix4d F = Eigen::Matrix4d::Identity();
    F(0, 2) = F(1, 3) = dt;
    Eigen::Matrix<double, 4, 2> G;
    G << dt * dt / 2, 0, 0, dt * dt / 2, dt, 0, 0, dt;
    state = F * state;
    covariance = F * covariance * F.transpose() + 9 * G * G.transpose();
  }
  Eigen::Matrix2d innovation() const {
    return covariance.topLeftCorner<2, 2>() + 0.09 * Eigen::Matrix2d::Identity();
  }
  void update(const Eigen::Vector2d& place) {
    const Eigen::Matrix<double, 4, 2> K = covariance.leftCols<2>() * innovation().inverse();
    state += K * (place - state.head<2>());
    covariance -= K * covariance.topRows<2>();
    misses = 0, ++hits;
  }
};

/// The pipeline of libraries.
class Peer {
 public:
  void add(const SensorFrame& frame) {
    const auto cloud = costs_.of("thin out", [&] { return thinned(frame); });
    const auto obstacles = costs_.of("ground", [&] { return aboveGround(cloud); });
    const auto places =
        costs_.of("clusters", [&] { return centers(obstacles, frame.ego.T_world_ego); });
    costs_.of("filter", [&] { return track(places, frame.stamp), 0; });
  }
  const Costs& costs() const { return costs_; }
  /// Its places are centers of what is seen, not of objects.
  bool hasTrackNear(const SceneObject& object) const {
    for (const PeerTrack& track : tracks_)
      if ((track.state.head<2>() - object.position.head<2>()).norm() < 2 + object.length / 2)
        return true;
    return false;
  }
  std::size_t tracks() const { return tracks_.size(); }

 private:
  static Cloud::Ptr thinned(const SensorFrame& frame) {
    const auto& points = std::get<LidarCloud>(frame.data);
    const Eigen::Affine3f T(frame.T_ego_sensor.cast<float>().matrix());
    Cloud::Ptr all(new Cloud), few(new Cloud);
    all->reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3f p = T * Eigen::Vector3f(points.x[i], points.y[i], points.z[i]);
      if (p.head<2>().norm() < 80) all->push_back(pcl::PointXYZ(p.x(), p.y(), p.z()));
    }
    pcl::VoxelGrid<pcl::PointXYZ> grid;
    grid.setInputCloud(all);
    grid.setLeafSize(0.1F, 0.1F, 0.1F);
    grid.filter(*few);
    return few;
  }

  static Cloud::Ptr aboveGround(const Cloud::Ptr& cloud) {
    pcl::SACSegmentation<pcl::PointXYZ> segmentation;
    segmentation.setOptimizeCoefficients(true);
    segmentation.setModelType(pcl::SACMODEL_PLANE);
    segmentation.setMethodType(pcl::SAC_RANSAC);
    segmentation.setMaxIterations(200);
    segmentation.setDistanceThreshold(0.2);
    segmentation.setInputCloud(cloud);
    pcl::PointIndices inliers;
    pcl::ModelCoefficients plane;
    segmentation.segment(inliers, plane);
    std::vector<char> ground(cloud->size(), 0);
    for (const int i : inliers.indices) ground[static_cast<std::size_t>(i)] = 1;
    Cloud::Ptr obstacles(new Cloud);
    for (std::size_t i = 0; i < cloud->size(); ++i)
      if (!ground[i] && (*cloud)[i].z > 0.2F && (*cloud)[i].z < 3)
        obstacles->push_back((*cloud)[i]);
    return obstacles;
  }

  static std::vector<Eigen::Vector2d> centers(const Cloud::Ptr& obstacles, const Pose3& ego) {
    std::vector<Eigen::Vector2d> places;
    if (obstacles->empty()) return places;
    pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
    tree->setInputCloud(obstacles);
    pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
    extraction.setClusterTolerance(0.5);
    extraction.setMinClusterSize(10);
    extraction.setMaxClusterSize(25000);
    extraction.setSearchMethod(tree);
    extraction.setInputCloud(obstacles);
    std::vector<pcl::PointIndices> found;
    extraction.extract(found);
    for (const pcl::PointIndices& cluster : found) {
      Vector3 sum = Vector3::Zero();
      for (const int i : cluster.indices)
        sum += (*obstacles)[static_cast<std::size_t>(i)].getVector3fMap().cast<double>();
      places.emplace_back((ego * (sum / static_cast<double>(cluster.indices.size()))).head<2>());
    }
    return places;
  }

  void track(const std::vector<Eigen::Vector2d>& places, Stamp stamp) {
    const double dt = stamp_ ? stamp.seconds() - stamp_->seconds() : 0;
    stamp_ = stamp;
    std::vector<char> used(places.size(), 0);
    for (PeerTrack& track : tracks_) {
      track.predict(dt);
      constexpr double kGate = 9.21;  // 99 % of two axes
      const Eigen::Matrix2d weight = track.innovation().inverse();
      double least = kGate;
      std::size_t best = places.size();
      for (std::size_t i = 0; i < places.size(); ++i) {
        const Eigen::Vector2d off = places[i] - track.state.head<2>();
        const double distance = off.dot(weight * off);
        if (!used[i] && distance < least) least = distance, best = i;
      }
      if (best == places.size()) {
        ++track.misses;
      } else {
        used[best] = 1, track.update(places[best]);
      }
    }
    tracks_.erase(std::remove_if(tracks_.begin(), tracks_.end(),
                                 [](const PeerTrack& t) { return t.misses > 5; }),
                  tracks_.end());
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (used[i]) continue;
      PeerTrack track;
      track.state << places[i], 0, 0;
      tracks_.push_back(track);
    }
  }

  std::vector<PeerTrack> tracks_;
  std::optional<Stamp> stamp_;
  Costs costs_;
};

/// Copies the lidar scans that the pipeline processes.
class Scans : public PipelineObserver {
 public:
  std::vector<SensorFrame> frames;
  double seconds = 0;  ///< [s] of CPU time for the copies
  std::size_t returns = 0;

  void onFrame(const SensorFrame& frame) override {
    if (!std::holds_alternative<LidarCloud>(frame.data)) return;
    const double begin = cpuSeconds();
    frames.push_back(frame);
    returns += std::get<LidarCloud>(frame.data).size();
    seconds += cpuSeconds() - begin;
  }
};

/// Runs both on a log and prints their costs; whether the two see the same.
bool compare(const std::string& ini, const std::string& log, const std::string& sensors) {
  EventLog events;
  RunTiming timing;
  Pipeline pipeline(PipelineSetup::fromFile(ini, {"run.sensors=" + sensors}), events, timing);
  Scans scans;
  pipeline.observe(&scans);
  Peer peer;
  double ours = 0;
  std::size_t count = 0, objects = 0, shared = 0;
  const auto step = [&](const auto& f) {
    const double begin = cpuSeconds(), copies = scans.seconds;
    auto result = f();
    ours += cpuSeconds() - begin - (scans.seconds - copies);
    for (const SensorFrame& frame : scans.frames) peer.add(frame), ++count;
    scans.frames.clear();
    return result;
  };
  const auto take = [&](bool end) {
    while (const auto scene = step([&] { return pipeline.next(end); })) {
      if (count < 5) continue;  // both have to find their tracks
      const Vector2 ego = scene->ego.T_world_ego.translation().head<2>();
      for (const SceneObject& object : scene->objects) {
        const auto hit = object.last_hit.find(Modality::kLidar);
        if (hit == object.last_hit.end() || scene->stamp - hit->second > 0.15 ||
            !object.classified || (object.position.head<2>() - ego).norm() > 20)
          continue;
        ++objects, shared += peer.hasTrackNear(object);
      }
    }
  };
  RawlogReader reader(log);
  while (const auto observation = step([&] { return reader.next(); }))
    step([&] { return pipeline.add(*observation), 0; }), take(false);
  take(true);
  if (count == 0) return fmt::print("{}: no lidar scan\n", log), false;

  const auto ms = [&](double seconds) { return 1e3 * seconds / static_cast<double>(count); };
  fmt::print("\n{} ({}): {} lidar scans of {} returns, ms of CPU time a scan, one thread\n", log,
             sensors, count, scans.returns / count);
  fmt::print("  {:<18}", "libraries");
  for (const std::string& stage : peer.costs().stages())
    fmt::print(" {} {:.2f}", stage, ms(peer.costs().of(stage)));
  fmt::print(" | all {:.2f}\n  {:<18}", ms(peer.costs().all()), "ours");
  for (const RunTiming::Stage& stage : timing.stages())
    fmt::print(" {} {:.2f}", stage.name, ms(stage.seconds));
  fmt::print(" | all, with reading {:.2f}\n", ms(ours));
  const double share = objects ? static_cast<double>(shared) / static_cast<double>(objects) : 0;
  fmt::print(
      "  libraries / ours: {:.1f}; {} certain objects within 20 m, {:.1f} % of them have a "
      "track of the peer nearby ({} tracks at the end)\n",
      peer.costs().all() / ours, objects, 100 * share, peer.tracks());
  return objects > 0 && share > 0.7;
}

}  // namespace
}  // namespace perception::bench

int main(int argc, char** argv) try {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  perception::registerPerceptionClasses();
  std::vector<std::string> args(argv + 1, argv + argc);
  const std::string source = PERCEPTION_SOURCE_DIR;
  if (args.empty()) args = {source + "/ini/demo.ini", source + "/rawlogs/demo.rawlog", "L"};
  if (args.size() == 2) args.emplace_back("L");
  if (args.size() % 3 != 0)
    return fmt::print(stderr, "usage: whole_bench [INI LOG SENSORS]...\n"), 64;
  bool same = true;
  for (std::size_t i = 0; i < args.size(); i += 3)
    same &= perception::bench::compare(args[i], args[i + 1], args[i + 2]);
  fmt::print("{}\n", same ? "\nboth see the same objects" : "\nFAULT: the two do not see the same");
  return same ? 0 : 1;
} catch (const std::exception& error) {
  return fmt::print(stderr, "whole_bench: error: {}\n", error.what()), 65;
}
