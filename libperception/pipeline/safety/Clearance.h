#pragma once
#include <cstddef>
#include <vector>

#include "libperception/grid/SafetyGrid.h"
#include "libperception/grid/beams/GridPoints.h"
#include "libperception/grid/way/FreeDistance.h"
#include "libperception/measurement/frames/PlacedReturns.h"
#include "libperception/measurement/frames/SensorFrame.h"

// What the vehicle passes over, and what it passes under.
namespace perception {

/// An obstacle of low returns, alone or together with higher ones.
struct LowObstacle {
  FreeDistance free;
  std::size_t returns = 0;  ///< number of returns that make it up
};

/// As denseReturns(), by `hits` with their `weights` and by those of the `others` that stand up. A
/// return stands up where heights within half a meter along the corridor and a quarter across it
/// differ by a tenth of a meter at least, which those of a road do not, and the highest is above a
/// car's underside. Heights are those above Corridor::road.
LowObstacle lowObstacle(const Corridor& corridor, const GridPoints& hits,
                        const std::vector<float>& weights, const GridPoints& others, double least);

/// Extends the beams of returns higher than `clearance` [m] above the ground into the cells, `cell`
/// [m] wide, of these returns, and appends them to those of `scan` that only clear: what hangs
/// there was taken for an obstacle as long as the road below it was hidden. Only up to the top of
/// the slab of obstacles above the vehicle's own plane: higher cells hold nothing. For grids in
/// space.
void clearOverhead(const SensorFrame& frame, const PlacedReturns& returns, double clearance,
                   double cell, GridScan& scan);

}  // namespace perception
