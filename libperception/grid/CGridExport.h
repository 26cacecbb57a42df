#pragma once
#include <string>

#include "libperception/grid/SafetyGrid.h"

namespace perception {

/// Exports a grid for other programs; throws OutputError when a file cannot be written. OctoMap's
/// octree: FILE.ot with log-odds, FILE.bt with occupied and free only (octovis).
void saveOctree(const SafetyGrid& grid, const std::string& file);
/// MRPT's COccupancyGridMap2D (FILE.gridmap.gz, gridmap tools) or an image of it (FILE.png): a
/// ground cell is occupied when one of its cells is, else free when one is known.
void saveGround(const SafetyGrid& grid, const std::string& file);
/// Selects the format by the extension: .ot, .bt, .gridmap.gz, .png; throws a usage error for
/// others.
void saveGrid(const SafetyGrid& grid, const std::string& file);

}  // namespace perception
