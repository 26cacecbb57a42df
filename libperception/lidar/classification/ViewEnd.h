#pragma once
#include <cstdint>
#include <vector>

#include "libperception/lidar/LidarDetections.h"
#include "libperception/lidar/description/DescribedClusters.h"
#include "libperception/lidar/segments/DirectionCells.h"

namespace perception {

/// The upper end of a lidar's view, and what reaches it (method.md 8.10). The shape model takes the
/// highest return of a segment for its top. What is cut by the view goes on above it: most slim
/// things do, people hardly.
class ViewEnd {
 public:
  /// `cells`: of the scan's points. Borrows `found`.
  ViewEnd(const LidarDetections& found, const DirectionCells& cells);

  /// Whether the scan shows where its view ends: what is higher than people reaches the highest
  /// beam in several directions. In the open that beam may be the head of a person.
  bool isKnown() const { return known_; }

  /// Log odds of a person, or a cyclist, to a thing, by the place where the view cuts a slim
  /// segment; at most 0, and 0 where it is not cut. `obstacles`: indices into those of `found`.
  double evidence(const std::vector<std::uint32_t>& obstacles) const;

  /// Weighs the probabilities of a described cluster with it, if it is slim and may be a person.
  void weigh(DescribedCluster& cluster) const;

 private:
  const LidarDetections& found_;
  bool known_ = false;
};

}  // namespace perception
