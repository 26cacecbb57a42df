#pragma once
#include <memory>

#include "libperception/grid/SafetyGrid.h"

namespace perception {

/// Cells of the ground in MRPT's COccupancyGridMap2D: all heights of the slab in one cell, so a
/// bridge blocks and a low obstacle seen once may be cleared by a beam above it, but a scan costs a
/// few milliseconds. Log-odds in steps of 1/16, MRPT's.
std::unique_ptr<SafetyGrid> makeGridMrpt2d(const GridParams& params);

}  // namespace perception
