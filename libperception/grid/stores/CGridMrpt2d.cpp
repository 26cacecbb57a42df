#include "libperception/grid/stores/CGridMrpt2d.h"

#include <mrpt/maps/COccupancyGridMap2D.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "libperception/grid/stores/ScanEvidence.h"

namespace perception {
namespace {

using mrpt::maps::COccupancyGridMap2D;

constexpr double kUnitsPerLogOdd = 16;  // CLogOddsGridMapLUT: LOGODD_K; MRPT's sign: free is > 0
constexpr double kDecayShare = 0.1;     // of tau between decays: smaller ones are lost to rounding

class CGridMrpt2d final : public SafetyGrid {
 public:
  explicit CGridMrpt2d(const GridParams& params)
      : SafetyGrid(params),
        evidence_(params, true),
        cells_(static_cast<int>(std::ceil(params.size / params.resolution))) {
    static_assert(std::is_same_v<Cell, COccupancyGridMap2D::cellType>);
    // MRPT's map coordinates are floats: they begin at 0, and the window's corner is stored in
    // cells.
    const auto edge = static_cast<float>(static_cast<double>(cells_) * params.resolution);
    map_.setSize(0, edge, 0, edge, static_cast<float>(params.resolution), 0.5F);
  }

  GridStats insert(const GridScan& scan) override {
    GridStats stats;
    if (!scan.T_world_ground.matrix().allFinite()) return stats;
    advance(scan, stats);
    for (const CellEvidence& cell : evidence_.collect(scan, stats))
      if (const Cell* at = find(cell.cell)) add(cell.cell, cell.logOdds(params(), valueOf(*at)));
    return stats;
  }

  double logOdds(const Vector3& place) const override {
    if (!place.allFinite()) return 0;
    const Cell* at = find(indexOf(place));
    return at ? valueOf(*at) : 0;
  }

  std::vector<GridCell> occupiedWithin(const GridArea& area) const override {
    return within(area, cellsWhere([this](double v) { return v > params().occupied; }));
  }
  std::vector<GridCell> knownCells() const override {
    return cellsWhere([](double v) { return v != 0; });
  }

  void restore(const std::vector<GridCell>& cells) override {
    for (const GridCell& cell : cells)
      if (const CellIndex index = indexOf(cell.center); find(index)) add(index, cell.log_odds);
  }

  std::size_t memoryBytes() const override {
    return static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_) * sizeof(Cell) +
           evidence_.memoryBytes();
  }

 private:
  using Cell = std::int8_t;  // log-odds in sixteenths (LOGODD_K), free is > 0; 0: unknown

  CellIndex indexOf(const Vector3& place) const {
    return {evidence_.indexOf(place.x()), evidence_.indexOf(place.y()), 0};
  }

  const Cell* find(const CellIndex& cell) const {
    const std::int64_t x = cell.x - corner_.x, y = cell.y - corner_.y;
    if (x < 0 || y < 0 || x >= cells_ || y >= cells_) return nullptr;
    return map_.getRow(static_cast<int>(y)) + x;
  }

  void advance(const GridScan& scan, GridStats& stats) {
    T_world_ground_ = scan.T_world_ground;
    CellIndex corner = indexOf(T_world_ground_.translation());
    corner.x -= cells_ / 2, corner.y -= cells_ / 2;
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

  // MRPT's maps cannot move: the window is shifted by copying rows within the map.
  void moveTo(const CellIndex& corner) {
    const std::int64_t dx = corner.x - corner_.x, dy = corner.y - corner_.y;
    const std::int64_t begin = std::max<std::int64_t>(0, -dx),
                       end = std::min<std::int64_t>(cells_, cells_ - dx);
    std::vector<Cell> old(static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_));
    for (int y = 0; y < cells_; ++y)
      std::copy_n(map_.getRow(y), cells_, old.begin() + std::int64_t{y} * cells_);
    for (int y = 0; y < cells_; ++y) {
      Cell* values = map_.getRow(y);
      std::fill_n(values, cells_, Cell{0});
      if (begin >= end || y + dy < 0 || y + dy >= cells_) continue;
      const auto from = old.begin() + (y + dy) * cells_ + dx;
      std::copy(from + begin, from + end, values + begin);
    }
    corner_ = corner;
  }

  void decay() {
    const double factor = pendingDecay();
    for (int y = 0; y < cells_; ++y) {
      Cell* values = map_.getRow(y);
      for (int x = 0; x < cells_; ++x) {
        Cell& cell = values[x];
        if (cell == 0) continue;
        const auto smaller = static_cast<Cell>(std::lround(cell * factor));
        // At least one step: rounding would keep small values forever.
        cell = smaller != cell ? smaller : static_cast<Cell>(cell - (cell > 0 ? 1 : -1));
      }
    }
    decayed_ = now_;
  }

  // Cells hold values at the time of the last decay.
  void add(const CellIndex& cell, double log_odds) {
    Cell& at = map_.getRow(static_cast<int>(cell.y - corner_.y))[cell.x - corner_.x];
    const double after = std::clamp(valueOf(at) + log_odds, params().low, params().high);
    at = static_cast<Cell>(std::lround(-after * kUnitsPerLogOdd / pendingDecay()));
  }

  double pendingDecay() const { return std::exp(-(now_ - decayed_) / params().tau); }

  double valueOf(Cell cell) const {
    return cell == 0 ? 0 : -cell / kUnitsPerLogOdd * pendingDecay();
  }

  template <class Wanted>
  std::vector<GridCell> cellsWhere(const Wanted& wanted) const {
    std::vector<GridCell> cells;
    for (int y = 0; y < cells_; ++y) {
      const Cell* values = map_.getRow(y);
      for (int x = 0; x < cells_; ++x)
        if (const double v = valueOf(values[x]); wanted(v))
          cells.push_back(describe(corner_.x + x, corner_.y + y, v));
    }
    return cells;
  }

  // Centered in the slab above the vehicle's ground plane.
  GridCell describe(std::int64_t column, std::int64_t row, double log_odds) const {
    const double res = params().resolution;
    const double x = evidence_.centerOf(column), y = evidence_.centerOf(row);
    const Vector3 origin = T_world_ground_.translation(), up = T_world_ground_.linear().col(2);
    const double ground =
        up.z() > 0.1 ? -(up.x() * (x - origin.x()) + up.y() * (y - origin.y())) / up.z() : 0;
    const double middle = (params().z_min + params().z_max) / 2;
    return {{x, y, origin.z() + ground + middle},
            {res, res, params().z_max - params().z_min},
            log_odds};
  }

  ScanEvidence evidence_;
  int cells_;  // along an edge
  COccupancyGridMap2D map_;
  CellIndex corner_;  // of the window, in cells of the world
  Pose3 T_world_ground_ = Pose3::Identity();
  bool started_ = false;
  Stamp now_, decayed_;  // of the last scan; of the last decay
};

}  // namespace

std::unique_ptr<SafetyGrid> makeGridMrpt2d(const GridParams& params) {
  return std::make_unique<CGridMrpt2d>(params);
}

}  // namespace perception
