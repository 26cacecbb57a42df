#pragma once
#include <vector>

#include "libperception/core/math/Random.h"
#include "libperception/simulation/RadarUnit.h"

namespace perception {

/// Mean ratio of the echo of the air to the noise in one resolution cell at `range` [m], method.md
/// (63).
double clutterRatio(const RadarAir& air, double range, const RadarUnitParams& params);

/// Cells in which the air alone exceeds the threshold (method.md (61), (63)): object -1, snr as
/// received. Draws nothing in clear air.
std::vector<RadarReflection> radarClutter(const RadarAir& air, const RadarUnitParams& params,
                                          const RadarMount& mount, Rng& rng);

}  // namespace perception
