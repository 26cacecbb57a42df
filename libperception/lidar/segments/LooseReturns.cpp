#include "libperception/lidar/segments/LooseReturns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "libperception/measurement/frames/PlacedReturns.h"
#include "libperception/simd/Vector8.h"

namespace perception {
namespace {

// All assumed.
constexpr float kBend = 0.3f;        // [m] in range, of a surface from cell to cell
constexpr int kLeastCells = 4;       // about a return that tell
constexpr float kLeastSolid = 0.3f;  // of these: the corner of a surface fills four in nine
constexpr int kLeastInRow = 3;       // the same where beams are far apart: one row of cells
constexpr float kGrazing = 0.05f;    // [-] of the range: a cell of 0.4 deg on a side at 8 deg
constexpr double kMostLoose = 0.5;   // of a cluster

/// Cells of direction about a return.
struct CellsAbout {
  int solid = 0, passed = 0;  ///< no beam, or one, returns from behind it
  bool loose() const {
    return solid + passed >= kLeastCells &&
           static_cast<float>(solid) < kLeastSolid * static_cast<float>(solid + passed);
  }
};

/// Of cells whose farthest range is `least` [m] or more those up to `behind` [m] and those beyond,
/// by rows of four of which the last does not count. The place is not at the border.
CellsAbout cellsWithin(const DirectionCells& cells, const DirectionCells::Place& place, float least,
                       float behind) {
  Int4 told{}, passed{};  // numbers below zero
  for (int row = place.row - 1; row <= place.row + 1; ++row) {
    const auto farthest = load<Float4>(cells.farthestFrom(place.column - 1, row));
    const Int4 tells = (farthest != 0.0f) & (farthest >= least);
    told += tells, passed += tells & (farthest > behind);
  }
  const int all = -(told[0] + told[1] + told[2]), gone = -(passed[0] + passed[1] + passed[2]);
  return {all - gone, gone};
}

/// About a return at `range` [m]. What ends nearer is solid: beside a return on a surface seen at a
/// grazing angle one side is nearer, one farther; but by more than `nearer` [m] it hides what it
/// would tell.
CellsAbout cellsAbout(const DirectionCells& cells, const DirectionCells::Place& place, float range,
                      float nearer) {
  const float least = range - nearer, behind = range + kBend;
  if (DirectionCells::isWithin(place)) return cellsWithin(cells, place, least, behind);
  CellsAbout about;
  for (int row = place.row - 1; row <= place.row + 1; ++row) {
    for (int column = place.column - 1; column <= place.column + 1; ++column) {
      const DirectionCells::Cell cell = cells.at(column, row);
      if (cell.empty() || cell.farthest < least) continue;
      ++(cell.farthest > behind ? about.passed : about.solid);
    }
  }
  return about;
}

/// Calls `use` with each of the points and what is about it; `slope` [-]: of a surface, by which
/// what is beside a return may be nearer.
template <class Use>
void forCellsAbout(const EgoPoints& all, const DirectionCells& cells,
                   const std::vector<std::uint32_t>& points, float slope, const Use& use) {
  const auto sx = static_cast<float>(all.sensor.x()), sy = static_cast<float>(all.sensor.y()),
             sz = static_cast<float>(all.sensor.z());
  constexpr std::size_t kBlock = 256;  // points that fit in the L1 cache
  std::array<float, kBlock> dx, dy, dz;
  std::array<DirectionCells::Place, kBlock> place;
  for (std::size_t first = 0; first < points.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, points.size() - first);
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t i = points[first + k];
      dx[k] = all.x[i] - sx, dy[k] = all.y[i] - sy, dz[k] = all.z[i] - sz;
    }
    DirectionCells::placeAll(dx.data(), dy.data(), dz.data(), count, place.data());
    for (std::size_t k = 0; k < count; ++k) {
      const float range = std::sqrt(dx[k] * dx[k] + dy[k] * dy[k] + dz[k] * dz[k]);
      use(static_cast<std::uint32_t>(first + k),
          cellsAbout(cells, place[k], range, kBend + slope * range));
    }
  }
}

}  // namespace

std::vector<float> solidShares(const EgoPoints& all, const DirectionCells& cells,
                               const std::vector<std::uint32_t>& points) {
  std::vector<float> shares(points.size(), PlacedReturns::kFewDirections);
  forCellsAbout(all, cells, points, kGrazing, [&](std::uint32_t k, const CellsAbout& about) {
    const int told = about.solid + about.passed;
    if (told >= kLeastInRow) shares[k] = static_cast<float>(about.solid) / static_cast<float>(told);
  });
  return shares;
}

std::vector<std::uint32_t> surfaceReturns(const EgoPoints& all, const DirectionCells& cells,
                                          const std::vector<std::uint32_t>& points) {
  std::vector<std::uint32_t> kept;
  kept.reserve(points.size());
  forCellsAbout(all, cells, points, std::numeric_limits<float>::infinity(),
                [&](std::uint32_t k, const CellsAbout& about) {
                  if (!about.loose()) kept.push_back(k);
                });
  const auto count = static_cast<double>(points.size());
  if (count - static_cast<double>(kept.size()) <= kMostLoose * count) return kept;
  kept.resize(points.size());
  for (std::uint32_t k = 0; k < points.size(); ++k) kept[k] = k;
  return kept;
}

}  // namespace perception
