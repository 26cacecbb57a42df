#include "libperception/grid/CGridMrpt2d.h"

#include <mrpt/maps/COccupancyGridMap2D.h>

#include <algorithm>
#include <cmath>

#include "libperception/grid/ScanEvidence.h"

namespace perception {
namespace {

using mrpt::maps::COccupancyGridMap2D;
using Cell = COccupancyGridMap2D::cellType;

constexpr double kUnitsPerLogOdd = 16;  // CLogOddsGridMapLUT: LOGODD_K; MRPT's sign: free is > 0
constexpr double kDecayShare = 0.1;  // of tau between decays: finer steps would vanish in rounding

class CGridMrpt2d final : public SafetyGrid {
 public:
  explicit CGridMrpt2d(const GridParams& params) : SafetyGrid(params), evidence_(params, true) {
    cells_ = static_cast<std::int64_t>(std::ceil(params.size / params.resolution));
    // MRPT's coordinates are floats: the map's own begin at 0, the window's corner is kept in
    // cells.
    const auto edge = static_cast<float>(static_cast<double>(cells_) * params.resolution);
    map_.setSize(0, edge, 0, edge, static_cast<float>(params.resolution), 0.5F);
  }

  GridStats insert(const GridScan& scan) override {
    GridStats stats;
    if (!scan.T_world_ground.matrix().allFinite()) return stats;
    advance(scan, stats);
    for (const CellEvidence& cell : evidence_.collect(scan, stats)) {
      if (Cell* at = find(cell.cell)) add(*at, cell.logOdds(params(), valueOf(*at)));
    }
    return stats;
  }

  double logOdds(const Vector3& place) const override {
    if (!place.allFinite()) return 0;
    const Cell* at = find({evidence_.indexOf(place.x()), evidence_.indexOf(place.y()), 0});
    return at ? valueOf(*at) : 0;
  }

  std::vector<GridCell> occupiedCells() const override {
    return cellsWhere([this](double v) { return v > params().occupied; });
  }
  std::vector<GridCell> knownCells() const override {
    return cellsWhere([](double v) { return v != 0; });
  }

  void restore(const std::vector<GridCell>& cells) override {
    for (const GridCell& cell : cells)
      if (Cell* at =
              find({evidence_.indexOf(cell.centre.x()), evidence_.indexOf(cell.centre.y()), 0}))
        add(*at, cell.log_odds);
  }

  template <class Wanted>
  std::vector<GridCell> cellsWhere(const Wanted& wanted) const {
    std::vector<GridCell> cells;
    const double height = params().z_max - params().z_min;
    for (std::int64_t y = 0; y < cells_; ++y) {
      const Cell* row = map_.getRow(static_cast<int>(y));
      for (std::int64_t x = 0; x < cells_; ++x) {
        const double log_odds = valueOf(row[x]);
        if (!wanted(log_odds)) continue;
        cells.push_back(
            {centreOf(x, y), {params().resolution, params().resolution, height}, log_odds});
      }
    }
    return cells;
  }

  std::size_t memoryBytes() const override {
    return map_.getRawMap().capacity() * sizeof(Cell) + evidence_.memoryBytes();
  }

 private:
  void advance(const GridScan& scan, GridStats& stats) {
    T_world_ground_ = scan.T_world_ground;
    const Vector3 centre = scan.T_world_ground.translation();
    const CellIndex corner = {evidence_.indexOf(centre.x()) - cells_ / 2,
                              evidence_.indexOf(centre.y()) - cells_ / 2, 0};
    if (!started_) {
      now_ = decayed_ = scan.stamp;
      corner_ = corner;
      started_ = true;
    }
    stats.late = scan.stamp < now_;
    now_ = std::max(now_, scan.stamp, [](Stamp a, Stamp b) { return a < b; });
    if (corner.x != corner_.x || corner.y != corner_.y) moveTo(corner);
    if (now_ - decayed_ >= kDecayShare * params().tau) decay();
  }

  // resizeGrid() only grows: the window rolls by copying the rows within the map.
  void moveTo(const CellIndex& corner) {
    const std::vector<Cell> old = map_.getRawMap();
    const auto width = static_cast<std::int64_t>(map_.getSizeX());
    map_.fill(0.5F);
    const std::int64_t dx = corner.x - corner_.x, dy = corner.y - corner_.y;
    const std::int64_t begin = std::max<std::int64_t>(0, -dx);
    const std::int64_t end = std::min<std::int64_t>(cells_, cells_ - dx);
    for (std::int64_t y = 0; y < cells_ && begin < end; ++y) {
      if (y + dy < 0 || y + dy >= cells_) continue;
      const auto from = old.begin() + (y + dy) * width + dx;
      std::copy(from + begin, from + end, map_.getRow(static_cast<int>(y)) + begin);
    }
    corner_ = corner;
  }

  void decay() {
    const double factor = pendingDecay();
    for (std::int64_t y = 0; y < cells_; ++y) {
      Cell* row = map_.getRow(static_cast<int>(y));
      for (std::int64_t x = 0; x < cells_; ++x) {
        if (row[x] == 0) continue;
        const auto smaller = static_cast<Cell>(std::lround(row[x] * factor));
        // Rounding would hold small values for ever.
        row[x] = smaller != row[x] ? smaller : static_cast<Cell>(row[x] - (row[x] > 0 ? 1 : -1));
      }
    }
    decayed_ = now_;
  }

  // Cells hold values as of the last decay.
  void add(Cell& cell, double log_odds) const {
    const double after = std::clamp(valueOf(cell) + log_odds, params().low, params().high);
    cell = static_cast<Cell>(std::lround(-after * kUnitsPerLogOdd / pendingDecay()));
  }

  double pendingDecay() const { return std::exp(-(now_ - decayed_) / params().tau); }

  double valueOf(Cell cell) const {
    return cell == 0 ? 0 : -cell / kUnitsPerLogOdd * pendingDecay();
  }

  const Cell* find(const CellIndex& cell) const {
    const std::int64_t x = cell.x - corner_.x, y = cell.y - corner_.y;
    if (x < 0 || y < 0 || x >= cells_ || y >= cells_) return nullptr;
    return map_.getRow(static_cast<int>(y)) + x;
  }
  Cell* find(const CellIndex& cell) {
    return const_cast<Cell*>(static_cast<const CGridMrpt2d*>(this)->find(cell));
  }

  // In the middle of the slab above the vehicle's ground plane.
  Vector3 centreOf(std::int64_t x, std::int64_t y) const {
    const Vector3 origin = T_world_ground_.translation(), up = T_world_ground_.linear().col(2);
    const Vector3 d(evidence_.centreOf(x + corner_.x) - origin.x(),
                    evidence_.centreOf(y + corner_.y) - origin.y(), 0);
    const double ground = up.z() > 0.1 ? -(up.x() * d.x() + up.y() * d.y()) / up.z() : 0;
    const double middle = (params().z_min + params().z_max) / 2;
    return {origin.x() + d.x(), origin.y() + d.y(), origin.z() + ground + middle};
  }

  ScanEvidence evidence_;
  COccupancyGridMap2D map_;
  std::int64_t cells_ = 0;  // along an edge
  CellIndex corner_;        // of the window, in cells of the world
  Pose3 T_world_ground_ = Pose3::Identity();
  bool started_ = false;
  Stamp now_, decayed_;  // of the last scan; up to which the cells have decayed
};

}  // namespace

std::unique_ptr<SafetyGrid> makeGridMrpt2d(const GridParams& params) {
  return std::make_unique<CGridMrpt2d>(params);
}

}  // namespace perception
