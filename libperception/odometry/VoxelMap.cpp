#include "libperception/odometry/VoxelMap.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <unordered_set>

namespace perception {
namespace {

constexpr std::uint32_t kLeastPoints = 6;   ///< of a surface; three span a plane (assumed)
constexpr std::uint32_t kMostPoints = 100;  ///< a cell that has them is known well enough
/// [m] A surface is thin where its points spread less than kThin, and wide where more than kWide:
/// between them lies a single ring of beams, which moves with the sensor and says nothing.
constexpr double kThin = 0.12, kWide = 0.15;
constexpr double kUprightAxis = 0.8;  ///< least |z| of the axis of a pole
constexpr double kPointSigma = 0.1;   ///< [m] noise of a point about its surface (assumed)

/// 21 bits an axis: 2000 km at 1 m.
std::uint64_t packed(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::int64_t kMask = (1 << 21) - 1;
  return static_cast<std::uint64_t>((x & kMask) << 42 | (y & kMask) << 21 | (z & kMask));
}

std::int64_t cellOf(double value, double edge) {
  return static_cast<std::int64_t>(std::floor(value / edge));
}

}  // namespace

std::uint64_t VoxelMap::keyOf(const Vector3& point, int dx, int dy, int dz) const {
  return packed(cellOf(point.x(), edge_) + dx, cellOf(point.y(), edge_) + dy,
                cellOf(point.z(), edge_) + dz);
}

void VoxelMap::measure(Cell& cell) {
  cell.known = false;
  if (cell.count < kLeastPoints) return;
  const double n = cell.count;
  const Vector3 offset = cell.sum / n;
  const Eigen::Matrix3d spread = cell.squares / n - offset * offset.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(spread);
  const Vector3 sigma = solver.eigenvalues().cwiseMax(0).cwiseSqrt();  // ascending
  const auto axis = [&](int i) -> Vector3 { return solver.eigenvectors().col(i); };
  Eigen::Matrix3d directions = axis(0) * axis(0).transpose();
  const bool plane = sigma[0] < kThin && sigma[1] > kWide;
  const bool pole = sigma[1] < kThin && sigma[2] > kWide && std::abs(axis(2).z()) > kUprightAxis;
  if (!plane && !pole) return;
  if (pole) directions += axis(1) * axis(1).transpose();
  cell.known = true;
  cell.surface.mean = cell.first + offset;
  cell.surface.information = directions / (kPointSigma * kPointSigma);
}

void VoxelMap::insert(const std::vector<Vector3>& points) {
  std::vector<Cell*> changed;
  changed.reserve(points.size());
  for (const Vector3& point : points) {
    Cell& cell = cells_[keyOf(point, 0, 0, 0)];
    if (cell.count >= kMostPoints) continue;
    if (cell.count == 0) cell.first = point;
    const Vector3 offset = point - cell.first;
    ++cell.count, cell.sum += offset, cell.squares += offset * offset.transpose();
    if (!cell.changed) changed.push_back(&cell);
    cell.changed = true;
  }
  for (Cell* cell : changed) {
    cell->changed = false;
    measure(*cell);
  }
}

void VoxelMap::keepNear(const Vector3& place, double range) {
  for (auto cell = cells_.begin(); cell != cells_.end();) {
    const bool far = (cell->second.first - place).squaredNorm() > range * range;
    cell = far ? cells_.erase(cell) : std::next(cell);
  }
}

const VoxelMap::Surface* VoxelMap::at(const Vector3& point, int dx, int dy, int dz) const {
  const auto found = cells_.find(keyOf(point, dx, dy, dz));
  return found == cells_.end() || !found->second.known ? nullptr : &found->second.surface;
}

std::vector<Vector3> thinned(const std::vector<Vector3>& points, double edge) {
  std::unordered_set<std::uint64_t> taken;
  taken.reserve(points.size());
  std::vector<Vector3> out;
  for (const Vector3& p : points) {
    if (taken.insert(packed(cellOf(p.x(), edge), cellOf(p.y(), edge), cellOf(p.z(), edge))).second)
      out.push_back(p);
  }
  return out;
}

}  // namespace perception
