#include "libperception/grid/CGridMrpt2d.h"

#include <mrpt/maps/COccupancyGridMap2D.h>

#include <type_traits>

#include "libperception/grid/ByteCellGrid.h"

namespace perception {
namespace {

using mrpt::maps::COccupancyGridMap2D;

class CGridMrpt2d final : public ByteCellGrid {
 public:
  explicit CGridMrpt2d(const GridParams& params) : ByteCellGrid(params, true) {
    static_assert(std::is_same_v<Cell, COccupancyGridMap2D::cellType>);
    // MRPT's coordinates are floats: the map's own begin at 0, the window's corner is kept in
    // cells.
    const auto edge = static_cast<float>(static_cast<double>(cells()) * params.resolution);
    map_.setSize(0, edge, 0, edge, static_cast<float>(params.resolution), 0.5F);
  }

 protected:
  const Cell* row(std::int64_t y, std::int64_t) const override {
    return map_.getRow(static_cast<int>(y));
  }

  CellIndex cornerOf(const Pose3& T_world_ground) const override {
    const Vector3 center = T_world_ground.translation();
    return {evidence().indexOf(center.x()) - cells() / 2,
            evidence().indexOf(center.y()) - cells() / 2, 0};
  }

  // In the middle of the slab above the vehicle's ground plane.
  GridCell describe(const CellIndex& cell, double log_odds) const override {
    const double res = params().resolution, x = evidence().centerOf(cell.x);
    const double y = evidence().centerOf(cell.y);
    const Vector3 origin = vehicle().translation(), up = vehicle().linear().col(2);
    const double ground =
        up.z() > 0.1 ? -(up.x() * (x - origin.x()) + up.y() * (y - origin.y())) / up.z() : 0;
    const double middle = (params().z_min + params().z_max) / 2;
    return {{x, y, origin.z() + ground + middle},
            {res, res, params().z_max - params().z_min},
            log_odds};
  }

 private:
  COccupancyGridMap2D map_;
};

}  // namespace

std::unique_ptr<SafetyGrid> makeGridMrpt2d(const GridParams& params) {
  return std::make_unique<CGridMrpt2d>(params);
}

}  // namespace perception
