#include "libperception/lidar/description/DescribedClusters.h"

#include <algorithm>
#include <utility>

namespace perception {

std::vector<DescribedCluster> describedClusters(const LidarDetections& found,
                                                const LidarCloud& cloud,
                                                const DirectionCells& cells,
                                                const ClusterVisitor& visit) {
  constexpr double kLeastReturns = 8, kLongest = 20;  // [m]
  constexpr float kLeastTop = 0.5f;                   // [m]
  std::vector<DescribedCluster> clusters;
  std::vector<int> number;  // of every segment; -1: too low
  ClusterDescriber describer(found, cloud, cells);
  const auto add = [&](const Segment& segment) {
    const bool low = std::all_of(segment.points.begin(), segment.points.end(),
                                 [&](std::uint32_t i) { return found.above[i] < kLeastTop; });
    number.push_back(low ? -1 : static_cast<int>(clusters.size()));
    if (low) return false;
    clusters.push_back({segment, describer.describe(segment.points)});
    int& whole = clusters.back().segment.whole;
    if (whole >= 0) whole = number[static_cast<std::size_t>(whole)];
    return !visit || visit(clusters.back());
  };
  Vector3 sensor = found.points.sensor;
  sensor.z() -= found.surface.heightAt(sensor.x(), sensor.y());
  findSegments(found.x, found.y, found.above, kLeastReturns, kLongest, found.trust, add, sensor);
  return clusters;
}

}  // namespace perception
