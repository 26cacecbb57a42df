#pragma once
#include <string>

#include "libperception/grid/SafetyGrid.h"

namespace perception {

/// Writes what a grid knows for other programs; OutputError when a file cannot be written.
/// OctoMap's octree: FILE.ot with log-odds, FILE.bt with occupied and free alone (octovis).
void saveOctree(const SafetyGrid& grid, const std::string& file);
/// MRPT's COccupancyGridMap2D (FILE.gridmap.gz, gridmap tools) or a picture of it (FILE.png): a
/// place is occupied when one of its cells is, else free when one is known.
void saveGround(const SafetyGrid& grid, const std::string& file);
/// As the file's ending says: .ot, .bt, .gridmap.gz, .png; a usage error for any other one.
void saveGrid(const SafetyGrid& grid, const std::string& file);

}  // namespace perception
