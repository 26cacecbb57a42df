#pragma once
#include "libperception/config/ParamSet.h"
#include "libperception/grid/FreeDistance.h"

namespace perception {

/// When to stop for what the grid shows ahead: [grid.stop].
struct StopParams {
  double width = 2.2;          ///< [m] of the corridor: a car and .2 m to each side (assumed)
  double reaction = 0.5;       ///< [s] from a scan to full braking (assumed)
  double deceleration = 4;     ///< [m/s^2] of braking: firm, on a wet road (assumed)
  double margin = 1;           ///< [m] that is to be left before the obstacle (assumed)
  double look_ahead = 80;      ///< [m] largest distance; bounded by the grid's window
  double steers_above = 2;     ///< [m/s] speed below which the path is taken for straight (assumed)
  double sharpest = 0.2;       ///< [1/m] curvature of a car's sharpest turn (assumed)
  int cells = 3;               ///< occupied, within half a meter: an obstacle (assumed)
  double obstacle_grow = 0.4;  ///< [m] by which an object's outline is grown to own a cell: two
                               ///< cells (assumed)
  double returns = 10;         ///< of one scan within half a meter that block the path (assumed)

  void visit(ParamVisitor& v);
};

/// The corridor along the arc that the vehicle drives at this instant; `yaw_rate` [rad/s], `speed`
/// and `T_world_ego` of the vehicle, `front` [m] x of its front.
Corridor drivenCorridor(const Pose3& T_world_ego, double speed, double yaw_rate, double front,
                        const StopParams& params);

/// [m] from the vehicle's front within which an obstacle calls for braking: v t + v^2 / (2 a) +
/// margin, less the way v_o^2 / (2 a) that an obstacle driving ahead at `along` >= 0 [m/s] still
/// covers when it brakes as hard; never below the margin.
double stoppingDistance(double speed, double along, const StopParams& params);

}  // namespace perception
