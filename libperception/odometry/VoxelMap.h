#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// A map of the surroundings in cubic cells, each a Gaussian of the points in it, reduced to the
/// directions in which a surface is thin (method.md 1.7).
class VoxelMap {
 public:
  /// What a cell says of a point near its mean: d^2 = e^T information e, e = mean - point.
  struct Surface {
    Vector3 mean = Vector3::Zero();                         ///< [m]
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< [1/m^2] n n^T / sigma^2
  };

  /// [m] edge of a cell.
  explicit VoxelMap(double edge) : edge_(edge) {}

  void insert(const std::vector<Vector3>& points);
  /// Removes the cells that are farther than `range` [m] from a place.
  void keepNear(const Vector3& place, double range);
  /// The surface of the cell at `point` moved by whole cells; null where none is known.
  const Surface* at(const Vector3& point, int dx, int dy, int dz) const;
  std::size_t size() const { return cells_.size(); }

 private:
  struct Cell {
    std::uint32_t count = 0;
    Vector3 sum = Vector3::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();  ///< about the cell's first point
    Vector3 first = Vector3::Zero();
    bool known = false, changed = false;
    Surface surface;
  };
  std::uint64_t keyOf(const Vector3& point, int dx, int dy, int dz) const;
  static void measure(Cell& cell);

  double edge_;
  std::unordered_map<std::uint64_t, Cell> cells_;
};

/// One point of every cube of this edge [m], the first in order.
std::vector<Vector3> thinned(const std::vector<Vector3>& points, double edge);

}  // namespace perception
