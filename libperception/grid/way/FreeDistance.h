#pragma once
#include <algorithm>
#include <functional>
#include <limits>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/grid/beams/GridPoints.h"

namespace perception {

/// One occupied cell. World frame.
struct GridCell {
  Vector3 center = Vector3::Zero();  ///< [m]
  Vector3 size = Vector3::Zero();    ///< [m] edges
  double log_odds = 0;
};

/// The area swept by the vehicle: an arc from the ego origin, tangent to its x axis.
struct Corridor {
  Pose3 T_world_ego = Pose3::Identity();
  bool backward = false;  ///< the vehicle reverses: the arc begins along -x
  double width = 2;       ///< [m] of the vehicle with its margin
  double curvature = 0;   ///< [1/m] of the steering; positive turns left of the direction of travel
  double from = 2.5;      ///< [m] along the arc: end of the own vehicle and the lidar's blind spot
  double max = 60;        ///< [m] along the arc: largest distance
  int cells = 1;          ///< occupied cells within half a meter along the arc that block it
  /// [m] height of the road in the ego frame, every meter along the arc from 0 on, and as the last
  /// one beyond; empty: 0.
  std::vector<float> road;

  double roadAt(double s) const;  ///< [m]
};

/// A rectangle along the world's axes [m]; by default everything.
struct GridArea {
  double x_min = -std::numeric_limits<double>::infinity(), x_max = -x_min;
  double y_min = x_min, y_max = x_max;
  bool holds(const Vector3& p) const {
    return p.x() >= x_min && p.x() <= x_max && p.y() >= y_min && p.y() <= y_max;
  }
};
/// Holds every place that is within half a meter of the corridor.
GridArea areaOf(const Corridor& corridor);

/// Free distance along a corridor.
struct FreeDistance {
  double distance = 0;   ///< [m] along the arc from the ego origin to the first obstacle, or max
  bool blocked = false;  ///< an obstacle was found
  Vector3 place = Vector3::Zero();  ///< [m] of its nearest cell or return, world
  double seen = 0;                  ///< [m] observed without a gap longer than 1 m

  /// [m] to which the way was seen and is free.
  double known() const { return std::min(distance, seen); }
};

/// Coordinates along (s) and across (d, positive left of the direction of travel) the corridor's
/// arc.
struct ArcPlace {
  double s = 0, d = 0;  ///< [m]
};
ArcPlace arcPlace(const Corridor& corridor, double x, double y);
/// Inverse of arcPlace(): x and y in the ego frame.
Vector2 onArc(const Corridor& corridor, const ArcPlace& place);

/// Free distance by the occupied cells; `step` [m] of the search, `log_odds_at`: log-odds at a
/// point [m, world], 0 = unknown.
FreeDistance freeDistance(const Corridor& corridor, const std::vector<GridCell>& occupied,
                          double step, const std::function<double(const Vector3&)>& log_odds_at);

/// [m] to which the corridor was observed without a gap over 1 m, from `seen` on, by beams to
/// `ends` from the sensor at `from` (world) that pass up to `height` [m], 1 m at most, above it.
double seenByBeams(const Corridor& corridor, double seen, const Vector3& from,
                   const std::vector<const GridPoints*>& ends, double height);

}  // namespace perception
