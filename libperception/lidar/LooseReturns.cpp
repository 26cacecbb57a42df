#include "libperception/lidar/LooseReturns.h"

#include <cmath>

namespace perception {
namespace {

// All assumed.
constexpr float kBend = 0.3f;        // [m] in range, of a surface from cell to cell
constexpr int kLeastCells = 4;       // about a return that tell
constexpr double kLeastSolid = 0.3;  // of these: the corner of a surface fills four in nine
constexpr double kMostLoose = 0.5;   // of a cluster

/// Whether beams return from behind in most cells about a return at `range` [m]. What ends nearer
/// is solid: beside a return on a surface seen at a grazing angle one side is nearer, one farther.
bool isLoose(const DirectionCells& cells, const DirectionCells::Place& place, float range) {
  int solid = 0, passed = 0;
  for (int row = place.row - 1; row <= place.row + 1; ++row) {
    for (int column = place.column - 1; column <= place.column + 1; ++column) {
      const DirectionCells::Cell& cell = cells.at(column, row);
      if (cell.empty()) continue;
      ++(cell.farthest > range + kBend ? passed : solid);
    }
  }
  return solid + passed >= kLeastCells && solid < kLeastSolid * (solid + passed);
}

}  // namespace

std::vector<std::uint32_t> surfaceReturns(const EgoPoints& all, const DirectionCells& cells,
                                          const std::vector<std::uint32_t>& points) {
  const auto sx = static_cast<float>(all.sensor.x()), sy = static_cast<float>(all.sensor.y()),
             sz = static_cast<float>(all.sensor.z());
  std::vector<std::uint32_t> kept;
  kept.reserve(points.size());
  for (std::uint32_t k = 0; k < points.size(); ++k) {
    const std::uint32_t i = points[k];
    const float dx = all.x[i] - sx, dy = all.y[i] - sy, dz = all.z[i] - sz;
    if (!isLoose(cells, DirectionCells::placeOf(dx, dy, dz),
                 std::sqrt(dx * dx + dy * dy + dz * dz)))
      kept.push_back(k);
  }
  const auto count = static_cast<double>(points.size());
  if (count - static_cast<double>(kept.size()) <= kMostLoose * count) return kept;
  kept.resize(points.size());
  for (std::uint32_t k = 0; k < points.size(); ++k) kept[k] = k;
  return kept;
}

}  // namespace perception
