#pragma once
#include <memory>

#include "libperception/grid/SafetyGrid.h"

namespace perception {

/// 3D grid in one flat array that rolls with the vehicle: constant memory and a few milliseconds
/// per scan, for real time. Log-odds in steps of 1/2048; at most 64 layers.
std::unique_ptr<SafetyGrid> makeGridRolling(const GridParams& params);

/// The same in 2D: one cell for all heights of the slab.
std::unique_ptr<SafetyGrid> makeGridRolling2d(const GridParams& params);

}  // namespace perception
