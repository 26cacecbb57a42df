#pragma once
#include <memory>

#include "libperception/grid/SafetyGrid.h"

namespace perception {

/// Cells in space in MRPT's COccupancyGridMap3D. Log-odds in steps of 1/16, MRPT's; the flat array
/// is copied when the vehicle has moved by a cell.
std::unique_ptr<SafetyGrid> makeGridMrpt3d(const GridParams& params);

}  // namespace perception
