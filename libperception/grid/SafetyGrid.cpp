#include "libperception/grid/SafetyGrid.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "libperception/grid/stores/CGridMrpt2d.h"
#include "libperception/grid/stores/GridOctomap.h"
#include "libperception/grid/stores/GridRolling.h"

namespace perception {
namespace {

struct BackEndRow {
  GridParams::BackEnd back_end;
  std::unique_ptr<SafetyGrid> (*make)(const GridParams&);
};

constexpr BackEndRow kBackEnds[] = {{GridParams::BackEnd::kOctomap, &makeGridOctomap},
                                    {GridParams::BackEnd::kMrpt2d, &makeGridMrpt2d},
                                    {GridParams::BackEnd::kRolling, &makeGridRolling},
                                    {GridParams::BackEnd::kRolling2d, &makeGridRolling2d}};

}  // namespace

FreeDistance SafetyGrid::freeDistance(const Corridor& corridor) const {
  return perception::freeDistance(corridor, occupiedWithin(areaOf(corridor)), params_.resolution,
                                  [this](const Vector3& place) { return logOdds(place); });
}

std::vector<GridCell> SafetyGrid::within(const GridArea& area, std::vector<GridCell> cells) {
  const auto outside = [&](const GridCell& cell) { return !area.holds(cell.center); };
  cells.erase(std::remove_if(cells.begin(), cells.end(), outside), cells.end());
  return cells;
}

std::unique_ptr<SafetyGrid> makeSafetyGrid(const GridParams& params) {
  for (const BackEndRow& row : kBackEnds) {
    if (row.back_end == params.back_end) return row.make(params);
  }
  return nullptr;  // unreachable: the parameter is one of the rows
}

}  // namespace perception
