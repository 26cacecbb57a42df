#pragma once
#include <limits>
#include <vector>

#include "libperception/grid/SafetyGrid.h"
#include "libperception/grid/way/StopAdvice.h"
#include "libperception/measurement/Measurement.h"
#include "libperception/pipeline/safety/RoadHeights.h"
#include "libperception/weather/trust/TrustParams.h"

namespace perception {

inline constexpr float kDoubted = 0.5F;  ///< weight below which a return is likelier a phantom

/// The obstacle returns of a scan; the vectors are as long as the hits, or empty.
struct ObstacleScan {
  GridScan scan;  ///< hits weighted by 1 - their doubt
  /// [0, 1] weight of each hit as part of an obstacle seen in one scan: 0 where doubted, and as far
  /// as something may make phantoms there, without a cluster.
  std::vector<float> dense;
  std::vector<char> doubted;  ///< by trust or shape, whether there is a cause for it or not
  /// May be a surface, though it has a cause to be doubted; empty: nothing may make phantoms.
  std::vector<char> surface;
  /// It lies outside wakes and clouds, and most directions about it end there, which ended its
  /// doubt in this scan. Empty where `surface` is.
  std::vector<char> solid;
  RoadHeights road;  ///< by the ground returns
};

/// Obstacle returns by their height, and those that only clear; mirror images below the road are
/// left out (method.md 8.1). The doubt about a return, by its trust and by the shape of its
/// cluster, is at most the probability of a cause that the sensors show (PhantomCauses, labels and
/// echoes by `trust`); none where the directions about it end there as at a wall (method.md 8.4).
/// What hangs higher than `clearance` [m] above the ground is no obstacle.
ObstacleScan obstacleScanOf(const SensorFrame& frame, const PlacedReturns& returns,
                            const TrustParams& trust = {}, const StopParams& stop = {},
                            double clearance = std::numeric_limits<double>::infinity());

}  // namespace perception
