#pragma once
#include <memory>

#include "libperception/grid/SafetyGrid.h"

namespace perception {

/// 2D grid in MRPT's COccupancyGridMap2D: one cell for all heights of the slab, so that a bridge
/// blocks and a beam above a low obstacle may clear it, at a few milliseconds per scan. Log-odds in
/// MRPT's steps of 1/16.
std::unique_ptr<SafetyGrid> makeGridMrpt2d(const GridParams& params);

}  // namespace perception
