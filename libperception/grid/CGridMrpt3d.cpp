#include "libperception/grid/CGridMrpt3d.h"

#include <mrpt/maps/COccupancyGridMap3D.h>

#include <algorithm>
#include <cmath>

#include "libperception/grid/ScanEvidence.h"

namespace perception {
namespace {

using mrpt::maps::COccupancyGridMap3D;
using Cell = COccupancyGridMap3D::voxelType;

constexpr double kUnitsPerLogOdd = 16;  // CLogOddsGridMapLUT: LOGODD_K; MRPT's sign: free is > 0
constexpr double kDecayShare = 0.1;  // of tau between decays: finer steps would vanish in rounding

class CGridMrpt3d final : public SafetyGrid {
 public:
  explicit CGridMrpt3d(const GridParams& params) : SafetyGrid(params), evidence_(params, false) {
    cells_ = static_cast<std::int64_t>(std::ceil(params.size / params.resolution));
    const double spread = 2 * params.grade * params.size * std::sqrt(0.5);
    layers_ = static_cast<std::int64_t>(
        std::ceil((params.z_max - params.z_min + spread) / params.resolution));
    // MRPT's coordinates are floats: the map's own begin at 0, the window's corner is kept in
    // cells.
    const auto edge = static_cast<float>(static_cast<double>(cells_) * params.resolution);
    const auto top = static_cast<float>(static_cast<double>(layers_) * params.resolution);
    const auto resolution = static_cast<float>(params.resolution);
    map_.setSize({0, 0, 0}, {edge, edge, top}, resolution, 0.5F);
  }

  GridStats insert(const GridScan& scan) override {
    GridStats stats;
    if (!scan.T_world_ground.matrix().allFinite()) return stats;
    advance(scan, stats);
    for (const CellEvidence& cell : evidence_.collect(scan, stats))
      if (Cell* at = find(cell.cell)) add(*at, cell.logOdds(params(), valueOf(*at)));
    return stats;
  }

  double logOdds(const Vector3& place) const override {
    if (!place.allFinite()) return 0;
    const Cell* at = find(
        {evidence_.indexOf(place.x()), evidence_.indexOf(place.y()), evidence_.indexOf(place.z())});
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
      if (Cell* at = find({evidence_.indexOf(cell.centre.x()), evidence_.indexOf(cell.centre.y()),
                           evidence_.indexOf(cell.centre.z())}))
        add(*at, cell.log_odds);
  }

  std::size_t memoryBytes() const override {
    return static_cast<std::size_t>(cells_ * cells_ * layers_) * sizeof(Cell) +
           evidence_.memoryBytes();
  }

 private:
  template <class Wanted>
  std::vector<GridCell> cellsWhere(const Wanted& wanted) const {
    std::vector<GridCell> cells;
    for (std::int64_t z = corner_.z; z < corner_.z + layers_; ++z)
      for (std::int64_t y = corner_.y; y < corner_.y + cells_; ++y)
        for (std::int64_t x = corner_.x; x < corner_.x + cells_; ++x) {
          const double v = valueOf(*find({x, y, z}));
          if (wanted(v))
            cells.push_back({{evidence_.centreOf(x), evidence_.centreOf(y), evidence_.centreOf(z)},
                             Vector3::Constant(params().resolution),
                             v});
        }
    return cells;
  }

  void advance(const GridScan& scan, GridStats& stats) {
    const Vector3 centre = scan.T_world_ground.translation();
    const double below = params().grade * params().size * std::sqrt(0.5) - params().z_min;
    const CellIndex corner = {evidence_.indexOf(centre.x()) - cells_ / 2,
                              evidence_.indexOf(centre.y()) - cells_ / 2,
                              evidence_.indexOf(centre.z() - below)};
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

  void moveTo(const CellIndex& corner) {
    const COccupancyGridMap3D old = map_;
    const CellIndex from = corner_;
    map_.fill(0.5F);
    corner_ = corner;
    const auto begin = [](std::int64_t a, std::int64_t b) { return std::max(a, b); };
    const auto end = [](std::int64_t a, std::int64_t b, std::int64_t n) {
      return std::min(a, b) + n;
    };
    const std::int64_t x0 = begin(from.x, corner.x), x1 = end(from.x, corner.x, cells_);
    for (std::int64_t z = begin(from.z, corner.z); z < end(from.z, corner.z, layers_); ++z)
      for (std::int64_t y = begin(from.y, corner.y); y < end(from.y, corner.y, cells_); ++y) {
        if (x0 >= x1) return;
        const Cell* source = old.m_grid.cellByIndex(static_cast<unsigned>(x0 - from.x),
                                                    static_cast<unsigned>(y - from.y),
                                                    static_cast<unsigned>(z - from.z));
        std::copy(source, source + (x1 - x0), find({x0, y, z}));
      }
  }

  void decay() {
    const double factor = pendingDecay();
    Cell* cell = map_.m_grid.cellByIndex(0, 0, 0);
    for (std::int64_t i = 0; i < cells_ * cells_ * layers_; ++i, ++cell) {
      if (*cell == 0) continue;
      const auto smaller = static_cast<Cell>(std::lround(*cell * factor));
      // Rounding would hold small values for ever.
      *cell = smaller != *cell ? smaller : static_cast<Cell>(*cell - (*cell > 0 ? 1 : -1));
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
    const std::int64_t x = cell.x - corner_.x, y = cell.y - corner_.y, z = cell.z - corner_.z;
    if (x < 0 || y < 0 || z < 0 || x >= cells_ || y >= cells_ || z >= layers_) return nullptr;
    return map_.m_grid.cellByIndex(static_cast<unsigned>(x), static_cast<unsigned>(y),
                                   static_cast<unsigned>(z));
  }
  Cell* find(const CellIndex& cell) {
    return const_cast<Cell*>(static_cast<const CGridMrpt3d*>(this)->find(cell));
  }

  ScanEvidence evidence_;
  COccupancyGridMap3D map_;
  std::int64_t cells_ = 0, layers_ = 0;  // along an edge, upwards
  CellIndex corner_;                     // of the window, in cells of the world
  bool started_ = false;
  Stamp now_, decayed_;  // of the last scan; up to which the cells have decayed
};

}  // namespace

std::unique_ptr<SafetyGrid> makeGridMrpt3d(const GridParams& params) {
  return std::make_unique<CGridMrpt3d>(params);
}

}  // namespace perception
