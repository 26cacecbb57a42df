#pragma once
#include <vector>

#include "libperception/lidar/EgoPoints.h"
#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// Returns that may be of the ground: a low one of every polar cell.
struct GroundCandidates {
  std::vector<float> x, y, z;  ///< [m] ego frame
  std::size_t size() const { return x.size(); }
};

/// Polar cells about the vehicle, and which of their returns is taken: as GroundParams.
struct CandidateRules {
  int sectors;
  double ring, range_min, range_max;  ///< [m]
  double quantile;                    ///< height of the candidate among a cell's returns
  int cell_points;                    ///< fewer returns give none
  GroundPlane plane;                  ///< of before
  double depth;                       ///< [m] below it returns are mirrored and do not count
};

GroundCandidates groundCandidates(const EgoPoints& points, const CandidateRules& rules);

}  // namespace perception
