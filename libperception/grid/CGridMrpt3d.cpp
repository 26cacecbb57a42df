#include "libperception/grid/CGridMrpt3d.h"

#include <mrpt/maps/COccupancyGridMap3D.h>

#include <cmath>
#include <type_traits>

#include "libperception/grid/ByteCellGrid.h"

namespace perception {
namespace {

using mrpt::maps::COccupancyGridMap3D;

class CGridMrpt3d final : public ByteCellGrid {
 public:
  explicit CGridMrpt3d(const GridParams& params) : ByteCellGrid(params, false) {
    static_assert(std::is_same_v<Cell, COccupancyGridMap3D::voxelType>);
    // MRPT's coordinates are floats: the map's own begin at 0, the window's corner is kept in
    // cells.
    const auto edge = static_cast<float>(static_cast<double>(cells()) * params.resolution);
    const auto top = static_cast<float>(static_cast<double>(layers()) * params.resolution);
    map_.setSize({0, 0, 0}, {edge, edge, top}, static_cast<float>(params.resolution), 0.5F);
  }

 protected:
  const Cell* row(std::int64_t y, std::int64_t z) const override {
    return map_.m_grid.cellByIndex(0, static_cast<unsigned>(y), static_cast<unsigned>(z));
  }

  CellIndex cornerOf(const Pose3& T_world_ground) const override {
    const Vector3 center = T_world_ground.translation();
    const double below = params().grade * params().size * std::sqrt(0.5) - params().z_min;
    return {evidence().indexOf(center.x()) - cells() / 2,
            evidence().indexOf(center.y()) - cells() / 2, evidence().indexOf(center.z() - below)};
  }

  GridCell describe(const CellIndex& cell, double log_odds) const override {
    return {{evidence().centerOf(cell.x), evidence().centerOf(cell.y), evidence().centerOf(cell.z)},
            Vector3::Constant(params().resolution),
            log_odds};
  }

 private:
  COccupancyGridMap3D map_;
};

}  // namespace

std::unique_ptr<SafetyGrid> makeGridMrpt3d(const GridParams& params) {
  return std::make_unique<CGridMrpt3d>(params);
}

}  // namespace perception
