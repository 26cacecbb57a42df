#include "libperception/lidar/LooseReturns.h"

#include <cmath>

#include "libperception/measurement/PlacedReturns.h"

namespace perception {
namespace {

// All assumed.
constexpr float kBend = 0.3f;        // [m] in range, of a surface from cell to cell
constexpr int kLeastCells = 4;       // about a return that tell
constexpr float kLeastSolid = 0.3f;  // of these: the corner of a surface fills four in nine
constexpr double kMostLoose = 0.5;   // of a cluster

/// Share of the cells about a return at `range` [m] in which no beam returns from behind it;
/// PlacedReturns::kFewDirections: too few cells tell. What ends nearer is solid: beside a return on
/// a surface seen at a grazing angle one side is nearer, one farther.
float solidShare(const DirectionCells& cells, const DirectionCells::Place& place, float range) {
  int solid = 0, passed = 0;
  for (int row = place.row - 1; row <= place.row + 1; ++row) {
    for (int column = place.column - 1; column <= place.column + 1; ++column) {
      const DirectionCells::Cell& cell = cells.at(column, row);
      if (cell.empty()) continue;
      ++(cell.farthest > range + kBend ? passed : solid);
    }
  }
  if (solid + passed < kLeastCells) return PlacedReturns::kFewDirections;
  return static_cast<float>(solid) / static_cast<float>(solid + passed);
}

}  // namespace

std::vector<float> solidShares(const EgoPoints& all, const DirectionCells& cells,
                               const std::vector<std::uint32_t>& points) {
  const auto sx = static_cast<float>(all.sensor.x()), sy = static_cast<float>(all.sensor.y()),
             sz = static_cast<float>(all.sensor.z());
  std::vector<float> shares;
  shares.reserve(points.size());
  for (const std::uint32_t i : points) {
    const float dx = all.x[i] - sx, dy = all.y[i] - sy, dz = all.z[i] - sz;
    shares.push_back(solidShare(cells, DirectionCells::placeOf(dx, dy, dz),
                                std::sqrt(dx * dx + dy * dy + dz * dz)));
  }
  return shares;
}

std::vector<std::uint32_t> surfaceReturns(const EgoPoints& all, const DirectionCells& cells,
                                          const std::vector<std::uint32_t>& points) {
  const std::vector<float> solid = solidShares(all, cells, points);
  std::vector<std::uint32_t> kept;
  kept.reserve(points.size());
  for (std::uint32_t k = 0; k < points.size(); ++k)
    if (solid[k] == PlacedReturns::kFewDirections || solid[k] >= kLeastSolid) kept.push_back(k);
  const auto count = static_cast<double>(points.size());
  if (count - static_cast<double>(kept.size()) <= kMostLoose * count) return kept;
  kept.resize(points.size());
  for (std::uint32_t k = 0; k < points.size(); ++k) kept[k] = k;
  return kept;
}

}  // namespace perception
