#pragma once
#include <vector>

#include "libperception/lidar/EgoPoints.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Ground candidates: a low return of every polar cell (method.md 8.1).
struct GroundCandidates {
  std::vector<float> x, y, z;  ///< [m] ego frame
  std::size_t size() const { return x.size(); }
};

/// Polar cells about the vehicle and the choice of their candidate, as in GroundParams.
struct CandidateRules {
  int sectors;
  double ring, range_min, range_max;  ///< [m]
  double quantile;                    ///< height of the candidate among a cell's returns
  int cell_points;                    ///< least number of returns
  GroundPlane plane;                  ///< previous estimate
  double depth;                       ///< [m] below it, returns are mirrored and ignored
};

GroundCandidates groundCandidates(const EgoPoints& points, const CandidateRules& rules);

}  // namespace perception
