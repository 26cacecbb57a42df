#pragma once
#include <functional>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// One occupied cell. World frame.
struct GridCell {
  Vector3 center = Vector3::Zero();  ///< [m]
  Vector3 size = Vector3::Zero();    ///< [m] edges
  double log_odds = 0;
};

/// The lane that the vehicle will sweep: an arc from the ego origin, tangent to its x axis.
struct Corridor {
  Pose3 T_world_ego = Pose3::Identity();
  double width = 2;      ///< [m] of the vehicle with its margin
  double curvature = 0;  ///< [1/m] of the steering; positive turns left
  double from = 2.5;     ///< [m] along the arc: the own body and the lidar's blind spot end here
  double max = 60;       ///< [m] along the arc: how far to look
};

/// What lies ahead in a corridor.
struct FreeDistance {
  double distance =
      0;  ///< [m] along the arc from the ego origin to the first occupied cell, or max
  bool blocked = false;  ///< there is such a cell
  double seen = 0;       ///< [m] up to which the lidar has looked without a gap longer than 1 m:
                         ///< beyond it, no obstacle means nothing
};

/// Place along (s) and across (d, positive left) the corridor's arc of a point of the ego frame.
struct ArcPlace {
  double s = 0, d = 0;  ///< [m]
};
ArcPlace arcPlace(const Corridor& corridor, double x, double y);
/// The other way round: x and y of the ego frame.
Vector2 onArc(const Corridor& corridor, const ArcPlace& place);

/// `log_odds_at`: of any place of the world, 0 = unknown.
FreeDistance freeDistance(const Corridor& corridor, const std::vector<GridCell>& occupied,
                          double step, const std::function<double(const Vector3&)>& log_odds_at);

}  // namespace perception
