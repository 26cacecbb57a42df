#pragma once
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <unordered_map>
#include <vector>

#include "libperception/grid/SafetyGrid.h"
#include "libperception/lidar/EgoPoints.h"
#include "libperception/lidar/ground/GroundPlane.h"
#include "libperception/lidar/ground/GroundSurface.h"
#include "libperception/lidar/two_spacings/Clusters.h"
#include "libperception/weather/PointFilter.h"
#include "tests/support/LabeledScans.h"

namespace perception::test {

/// What a recording in bad weather does to safety grid and clusters, with or without a filter.
class SnowRun {
 public:
  SnowRun(const WeatherParams& weather, const GridParams& grid)
      : filter_(makePointFilter(weather)), grid_(makeSafetyGrid(grid)) {}

  /// A scan of the recording; `labels` may be empty.
  void add(const SensorFrame& scan, const std::vector<std::uint32_t>& labels) {
    frame_ = scan;
    frame_.ground = ground_.update(frame_);
    if (filter_) filter_->apply(frame_);
    fillGrid(labels);
    findThem(labels);
  }

  const SafetyGrid& grid() const { return *grid_; }
  const SensorFrame& frame() const { return frame_; }  ///< with ground and trust
  /// Occupied cells within `range` [m] that only falling snow has ever been in.
  std::size_t snowCells(double range) const {
    std::size_t count = 0;
    const Vector2 own = frame_.ego.T_world_ego.translation().head<2>();
    for (const GridCell& cell : grid_->occupiedCells()) {
      if ((cell.center.head<2>() - own).norm() > range) continue;
      const auto found = history_.find(keyOf(cell.center));
      count += found != history_.end() && found->second.snow > 0 && found->second.other == 0;
    }
    return count;
  }
  bool snowedIn(const Vector3& place) const {
    const auto found = history_.find(keyOf(place));
    return found != history_.end() && found->second.snow > 0;
  }
  /// Centers of the cells with two and more returns of cars and persons in the last scan.
  const std::vector<Vector3>& roadUserCells() const { return road_users_; }
  std::size_t clusters() const { return clusters_; }
  std::size_t snowClusters() const { return snow_clusters_; }  ///< mostly of falling snow

 private:
  struct History {
    int snow = 0, other = 0;  // [returns]
  };

  std::uint64_t keyOf(const Vector3& p) const {
    const double res = grid_->params().resolution;
    const auto part = [res](double v) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(v / res)) + 100000);
    };
    const GridParams::BackEnd kind = grid_->params().back_end;
    const bool flat =
        kind == GridParams::BackEnd::kMrpt2d || kind == GridParams::BackEnd::kRolling2d;
    return part(p.x()) << 40 | part(p.y()) << 20 | (flat ? 0 : part(p.z()));
  }

  void fillGrid(const std::vector<std::uint32_t>& labels) {
    PointParams limits;
    limits.vehicle_front = limits.vehicle_rear = 2.6;  // as ini/wads.ini
    points_ = usablePoints(frame_, limits);
    GroundSurface(frame_.ground, points_, {}, &heights_);
    const auto& cloud = std::get<LidarCloud>(frame_.data);
    GridScan scan;
    scan.stamp = frame_.stamp;
    scan.origin = frame_.T_world_sensor().translation();
    scan.T_world_ground = frame_.ego.T_world_ego * makePose(0, 0, frame_.ground.c, 0);
    std::unordered_map<std::uint64_t, std::pair<int, Vector3>> users;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (heights_[i] < -0.3F) continue;
      const Vector3 place = frame_.ego.T_world_ego * Vector3(static_cast<double>(points_.x[i]),
                                                             static_cast<double>(points_.y[i]),
                                                             static_cast<double>(points_.z[i]));
      const bool hit = heights_[i] > 0.3F && heights_[i] < 3;
      (hit ? scan.hits : scan.clear).push_back(place);
      if (!hit) continue;
      const std::uint32_t source = points_.source[i];
      if (!cloud.trust.empty()) scan.weights.push_back(cloud.trust[source]);
      if (labels.empty()) continue;
      History& history = history_[keyOf(place)];
      (labels[source] == kSnowLabel ? history.snow : history.other) += 1;
      if (isRoadUser(labels[source])) {
        auto& [count, where] = users[keyOf(place)];
        ++count, where = place;
      }
    }
    road_users_.clear();
    for (const auto& [key, user] : users)
      if (user.first >= 2) road_users_.push_back(user.second);
    grid_->insert(scan);
  }

  // Returns that are more likely phantoms than not start no cluster.
  void findThem(const std::vector<std::uint32_t>& labels) {
    const auto& cloud = std::get<LidarCloud>(frame_.data);
    std::vector<float> x, y, above;
    std::vector<std::uint32_t> source;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (heights_[i] < 0.3F || heights_[i] > 3) continue;
      if (!cloud.trust.empty() && cloud.trust[points_.source[i]] < 0.5F) continue;
      x.push_back(points_.x[i]), y.push_back(points_.y[i]), above.push_back(heights_[i]);
      source.push_back(points_.source[i]);
    }
    const auto found = findClusters(x, y, above, {});
    clusters_ = found.size(), snow_clusters_ = 0;
    if (labels.empty()) return;
    for (const Cluster& cluster : found) {
      std::size_t snow = 0;
      for (const std::uint32_t i : cluster.points) snow += labels[source[i]] == kSnowLabel;
      snow_clusters_ += 2 * snow > cluster.points.size();
    }
  }

  std::unique_ptr<PointFilter> filter_;
  std::unique_ptr<SafetyGrid> grid_;
  GroundEstimator ground_;
  SensorFrame frame_;
  EgoPoints points_;
  std::vector<float> heights_;
  std::unordered_map<std::uint64_t, History> history_;
  std::vector<Vector3> road_users_;
  std::size_t clusters_ = 0, snow_clusters_ = 0;
};

/// Two runs over the same scans, without and with trust.
struct SnowComparison {
  std::size_t scans = 0;
  double plain_cells = 0, trusted_cells = 0;        ///< occupied by snow alone, summed over scans
  double user_cells = 0, user_cells_kept = 0;       ///< of cars and persons
  double even_cells = 0, even_cells_kept = 0;       ///< of these: in scans of even number
  double clean_cells = 0, clean_cells_kept = 0;     ///< of these: no snow has ever been in them
  double plain_clusters = 0, trusted_clusters = 0;  ///< of snow
  double plain_all = 0, trusted_all = 0;            ///< all clusters

  double fewer() const { return plain_cells / std::max(1.0, trusted_cells); }
  double cleanKept() const { return clean_cells_kept / std::max(1.0, clean_cells); }
  double evenKept() const { return even_cells_kept / std::max(1.0, even_cells); }
  double kept() const { return user_cells_kept / std::max(1.0, user_cells); }
};

inline SnowComparison compareInSnow(const std::vector<LabeledScan>& scans,
                                    const WeatherParams& weather, GridParams grid) {
  WeatherParams off = weather;
  off.filter = "off";
  SnowRun plain(off, grid), trusted(weather, grid);
  SnowComparison sum;
  for (const LabeledScan& scan : scans) {
    plain.add(scan.frame, scan.labels), trusted.add(scan.frame, scan.labels);
    ++sum.scans;
    sum.plain_cells += static_cast<double>(plain.snowCells(15));
    sum.trusted_cells += static_cast<double>(trusted.snowCells(15));
    for (const Vector3& place : plain.roadUserCells()) {
      if (!plain.grid().isOccupied(place)) continue;
      const bool kept = trusted.grid().isOccupied(place);
      sum.user_cells += 1, sum.user_cells_kept += kept;
      if (scan.number % 2 == 0) sum.even_cells += 1, sum.even_cells_kept += kept;
      if (plain.snowedIn(place)) continue;  // snow has helped to mark it
      sum.clean_cells += 1, sum.clean_cells_kept += kept;
    }
    sum.plain_clusters += static_cast<double>(plain.snowClusters());
    sum.trusted_clusters += static_cast<double>(trusted.snowClusters());
    sum.plain_all += static_cast<double>(plain.clusters());
    sum.trusted_all += static_cast<double>(trusted.clusters());
  }
  return sum;
}

}  // namespace perception::test
