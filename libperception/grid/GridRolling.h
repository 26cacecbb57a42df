#pragma once
#include <memory>

#include "libperception/grid/SafetyGrid.h"

namespace perception {

/// Cells in space in one flat array that rolls with the vehicle: constant memory and a scan in a
/// few milliseconds, for real time. Log-odds in steps of 1/2048; at most 64 layers.
std::unique_ptr<SafetyGrid> makeGridRolling(const GridParams& params);

/// The same on the ground: all heights of the slab in one cell.
std::unique_ptr<SafetyGrid> makeGridRolling2d(const GridParams& params);

}  // namespace perception
