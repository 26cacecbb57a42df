#include "libperception/grid/CGridExport.h"

#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/serialization/CArchive.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "libperception/core/Error.h"

namespace perception {
namespace {

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// The highest log-odds of each ground cell, or the lowest where none is above 0.
std::map<std::pair<int, int>, double> groundOf(const std::vector<GridCell>& cells,
                                               double resolution, const Vector2& corner) {
  std::map<std::pair<int, int>, double> ground;
  for (const GridCell& cell : cells) {
    const Vector2 place = (cell.center.head<2>() - corner) / resolution;
    const auto [at, fresh] = ground.try_emplace(
        {static_cast<int>(std::floor(place.x())), static_cast<int>(std::floor(place.y()))},
        cell.log_odds);
    if (!fresh && (cell.log_odds > 0 ? cell.log_odds > at->second
                                     : at->second < 0 && cell.log_odds < at->second))
      at->second = cell.log_odds;
  }
  return ground;
}

}  // namespace

void saveGrid(const SafetyGrid& grid, const std::string& file) {
  if (endsWith(file, ".ot") || endsWith(file, ".bt")) {
    saveOctree(grid, file);
  } else if (endsWith(file, ".gridmap.gz") || endsWith(file, ".png")) {
    saveGround(grid, file);
  } else {
    throw Error(ExitCode::kUsage, file + ": expected a grid as .ot, .bt, .gridmap.gz or .png");
  }
}

void saveOctree(const SafetyGrid& grid, const std::string& file) {
  octomap::OcTree tree(grid.params().resolution);
  tree.setClampingThresMin(octomap::probability(grid.params().low));
  tree.setClampingThresMax(octomap::probability(grid.params().high));
  for (const GridCell& cell : grid.knownCells())
    tree.setNodeValue(cell.center.x(), cell.center.y(), cell.center.z(),
                      static_cast<float>(cell.log_odds), true);
  tree.updateInnerOccupancy();
  tree.prune();
  const bool written = endsWith(file, ".bt") ? tree.writeBinary(file) : tree.write(file);
  if (!written) throw OutputError(file + ": cannot be written");
}

void saveGround(const SafetyGrid& grid, const std::string& file) {
  const auto cells = grid.knownCells();
  const double resolution = grid.params().resolution;
  Vector2 low(-1, -1), high(1, 1);  // [m] a small empty map when no cell is known
  if (!cells.empty()) low = high = cells.front().center.head<2>();
  for (const GridCell& cell : cells) {
    low = low.cwiseMin(cell.center.head<2>()), high = high.cwiseMax(cell.center.head<2>());
  }
  const Vector2 corner = low - Vector2::Constant(resolution / 2);
  high += Vector2::Constant(resolution / 2);
  mrpt::maps::COccupancyGridMap2D map(static_cast<float>(corner.x()), static_cast<float>(high.x()),
                                      static_cast<float>(corner.y()), static_cast<float>(high.y()),
                                      static_cast<float>(resolution));
  for (const auto& [place, log_odds] : groundOf(cells, resolution, corner))
    map.setCell(place.first, place.second, static_cast<float>(1 / (1 + std::exp(log_odds))));
  if (endsWith(file, ".png")) {
    if (!map.saveAsBitmapFile(file)) throw OutputError(file + ": cannot be written");
    return;
  }
  mrpt::io::CFileGZOutputStream stream;
  if (!stream.open(file)) throw OutputError(file + ": cannot be written");
  mrpt::serialization::archiveFrom(stream) << map;
}

}  // namespace perception
