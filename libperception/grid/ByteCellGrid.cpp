#include "libperception/grid/ByteCellGrid.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

constexpr double kUnitsPerLogOdd = 16;  // CLogOddsGridMapLUT: LOGODD_K; MRPT's sign: free is > 0
constexpr double kDecayShare = 0.1;  // of tau between decays: finer steps would vanish in rounding

}  // namespace

ByteCellGrid::ByteCellGrid(const GridParams& params, bool flat)
    : SafetyGrid(params),
      evidence_(params, flat),
      flat_(flat),
      cells_(static_cast<std::int64_t>(std::ceil(params.size / params.resolution))) {
  if (flat) return;
  const double spread = 2 * params.grade * params.size * std::sqrt(0.5);
  layers_ = static_cast<std::int64_t>(
      std::ceil((params.z_max - params.z_min + spread) / params.resolution));
}

GridStats ByteCellGrid::insert(const GridScan& scan) {
  GridStats stats;
  if (!scan.T_world_ground.matrix().allFinite()) return stats;
  advance(scan, stats);
  for (const CellEvidence& cell : evidence_.collect(scan, stats))
    if (const Cell* at = find(cell.cell)) add(cell.cell, cell.logOdds(params(), valueOf(*at)));
  return stats;
}

double ByteCellGrid::logOdds(const Vector3& place) const {
  if (!place.allFinite()) return 0;
  const Cell* at = find(indexOf(place));
  return at ? valueOf(*at) : 0;
}

std::vector<GridCell> ByteCellGrid::occupiedCells() const {
  return cellsWhere([this](double v) { return v > params().occupied; });
}
std::vector<GridCell> ByteCellGrid::knownCells() const {
  return cellsWhere([](double v) { return v != 0; });
}

void ByteCellGrid::restore(const std::vector<GridCell>& cells) {
  for (const GridCell& cell : cells)
    if (const CellIndex index = indexOf(cell.center); find(index)) add(index, cell.log_odds);
}

std::size_t ByteCellGrid::memoryBytes() const {
  return static_cast<std::size_t>(cells_ * cells_ * layers_) * sizeof(Cell) +
         evidence_.memoryBytes();
}

template <class Wanted>
std::vector<GridCell> ByteCellGrid::cellsWhere(const Wanted& wanted) const {
  std::vector<GridCell> cells;
  for (std::int64_t z = 0; z < layers_; ++z)
    for (std::int64_t y = 0; y < cells_; ++y) {
      const Cell* values = row(y, z);
      for (std::int64_t x = 0; x < cells_; ++x) {
        const double v = valueOf(values[x]);
        if (wanted(v)) cells.push_back(describe({corner_.x + x, corner_.y + y, corner_.z + z}, v));
      }
    }
  return cells;
}

CellIndex ByteCellGrid::indexOf(const Vector3& place) const {
  return {evidence_.indexOf(place.x()), evidence_.indexOf(place.y()),
          flat_ ? corner_.z : evidence_.indexOf(place.z())};
}

const ByteCellGrid::Cell* ByteCellGrid::find(const CellIndex& cell) const {
  const std::int64_t x = cell.x - corner_.x, y = cell.y - corner_.y, z = cell.z - corner_.z;
  if (x < 0 || y < 0 || z < 0 || x >= cells_ || y >= cells_ || z >= layers_) return nullptr;
  return row(y, z) + x;
}

void ByteCellGrid::advance(const GridScan& scan, GridStats& stats) {
  T_world_ground_ = scan.T_world_ground;
  const CellIndex corner = cornerOf(T_world_ground_);
  if (!started_) {
    now_ = decayed_ = scan.stamp;
    corner_ = corner;
    started_ = true;
  }
  stats.late = scan.stamp < now_;
  now_ = std::max(now_, scan.stamp, [](Stamp a, Stamp b) { return a < b; });
  if (corner.x != corner_.x || corner.y != corner_.y || corner.z != corner_.z) moveTo(corner);
  if (now_ - decayed_ >= kDecayShare * params().tau) decay();
}

// MRPT's maps only grow: the window moves by copying rows within the map.
void ByteCellGrid::moveTo(const CellIndex& corner) {
  const std::int64_t dx = corner.x - corner_.x, dy = corner.y - corner_.y;
  const std::int64_t dz = corner.z - corner_.z;
  const std::int64_t begin = std::max<std::int64_t>(0, -dx), end = std::min(cells_, cells_ - dx);
  std::vector<Cell> old(static_cast<std::size_t>(cells_ * cells_ * layers_));
  for (std::int64_t z = 0; z < layers_; ++z)
    for (std::int64_t y = 0; y < cells_; ++y)
      std::copy_n(row(y, z), cells_, old.begin() + (z * cells_ + y) * cells_);
  for (std::int64_t z = 0; z < layers_; ++z)
    for (std::int64_t y = 0; y < cells_; ++y) {
      Cell* values = changeableRow(y, z);
      std::fill_n(values, cells_, Cell{0});
      if (begin >= end || y + dy < 0 || y + dy >= cells_ || z + dz < 0 || z + dz >= layers_)
        continue;
      const auto from = old.begin() + ((z + dz) * cells_ + y + dy) * cells_ + dx;
      std::copy(from + begin, from + end, values + begin);
    }
  corner_ = corner;
}

void ByteCellGrid::decay() {
  const double factor = pendingDecay();
  for (std::int64_t z = 0; z < layers_; ++z)
    for (std::int64_t y = 0; y < cells_; ++y) {
      Cell* values = changeableRow(y, z);
      for (std::int64_t x = 0; x < cells_; ++x) {
        Cell& cell = values[x];
        if (cell == 0) continue;
        const auto smaller = static_cast<Cell>(std::lround(cell * factor));
        // Rounding would hold small values for ever.
        cell = smaller != cell ? smaller : static_cast<Cell>(cell - (cell > 0 ? 1 : -1));
      }
    }
  decayed_ = now_;
}

// Cells hold values as of the last decay.
void ByteCellGrid::add(const CellIndex& cell, double log_odds) {
  Cell& at = changeableRow(cell.y - corner_.y, cell.z - corner_.z)[cell.x - corner_.x];
  const double after = std::clamp(valueOf(at) + log_odds, params().low, params().high);
  at = static_cast<Cell>(std::lround(-after * kUnitsPerLogOdd / pendingDecay()));
}

double ByteCellGrid::pendingDecay() const { return std::exp(-(now_ - decayed_) / params().tau); }

double ByteCellGrid::valueOf(Cell cell) const {
  return cell == 0 ? 0 : -cell / kUnitsPerLogOdd * pendingDecay();
}

}  // namespace perception
