#pragma once
#include <string>

#include "libperception/grid/SafetyGrid.h"

namespace perception {

/// A grid as a file for other programs, by the extension of its name. OctoMap's octree: .ot with
/// log-odds, .bt with occupied and free only (octovis). MRPT's COccupancyGridMap2D (.gridmap.gz,
/// gridmap tools) or an image of it (.png): a ground cell is occupied when one of its cells is,
/// else free when one is known. Throws a usage error for other names.
std::string gridFileOf(const SafetyGrid& grid, const std::string& name);
/// Writes it. Throws OutputError.
void saveGrid(const SafetyGrid& grid, const std::string& file);

}  // namespace perception
