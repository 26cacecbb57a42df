#pragma once
#include "libperception/grid/SafetyGrid.h"
#include "libperception/measurement/frames/PlacedReturns.h"
#include "libperception/measurement/frames/SensorFrame.h"

// What the vehicle passes under.
namespace perception {

/// Extends the beams of returns higher than `clearance` [m] above the ground into the cells, `cell`
/// [m] wide, of these returns, and appends them to those of `scan` that only clear: what hangs
/// there was taken for an obstacle as long as the road below it was hidden. Only up to the top of
/// the slab of obstacles above the vehicle's own plane: higher cells hold nothing. For grids in
/// space.
void clearOverhead(const SensorFrame& frame, const PlacedReturns& returns, double clearance,
                   double cell, GridScan& scan);

}  // namespace perception
