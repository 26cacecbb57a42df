#pragma once
#include "libperception/config/ParamSet.h"
#include "libperception/grid/way/FreeDistance.h"

namespace perception {

/// The own vehicle: [vehicle].
struct VehicleParams {
  double height = 0;  ///< [m] of its highest point above the ground; 0: of its highest lidar, 1.7
                      ///< at least (assumed: a car)

  void visit(ParamVisitor& v);
};

/// When to stop for what the grid shows on the way: [grid.stop].
struct StopParams {
  VehicleParams vehicle;
  double clearance =
      0.3;                ///< [m] to be left below what hangs: springs, errors of heights (assumed)
  double width = 2.2;     ///< [m] of the corridor: a car and .2 m to each side (assumed)
  double reaction = 0.5;  ///< [s] from a scan to full braking (assumed)
  double deceleration = 4;      ///< [m/s^2] of braking: firm, on a wet road (assumed)
  double margin = 1;            ///< [m] that is to be left before the obstacle (assumed)
  double look_ahead = 80;       ///< [m] that are looked at; farther where the stopping distance is
  double reverses_above = 0.2;  ///< [m/s] speed backward from which the way behind counts (assumed)
  double steers_above = 1;     ///< [m/s] speed below which the path is taken for straight (assumed)
  double sharpest = 0.2;       ///< [1/m] curvature of a car's sharpest turn (assumed)
  int cells = 3;               ///< occupied, within half a meter: an obstacle (assumed)
  double obstacle_grow = 0.4;  ///< [m] by which an object's outline is grown to own a cell: two
                               ///< cells (assumed)
  double returns = 10;         ///< of one scan within half a meter that block the path (assumed)

  void visit(ParamVisitor& v);
};

/// Whether the vehicle drives backward; `velocity` [m/s] in the world.
bool isReversing(const Pose3& T_world_ego, const Vector2& velocity, const StopParams& params);

/// The corridor along the arc that the vehicle drives at this instant, forward or backward, as long
/// as its stopping distance at least; `velocity` [m/s] in the world, `yaw_rate` [rad/s], `front`
/// and `rear` [m] of the vehicle from the ego origin.
Corridor drivenCorridor(const Pose3& T_world_ego, const Vector2& velocity, double yaw_rate,
                        double front, double rear, const StopParams& params);

/// [m] from the vehicle's front within which an obstacle calls for braking: v t + v^2 / (2 a) +
/// margin, less the way v_o^2 / (2 a) that an obstacle driving ahead at `along` >= 0 [m/s] still
/// covers when it brakes as hard; never below the margin.
double stoppingDistance(double speed, double along, const StopParams& params);

/// [m/s] from which the vehicle stops within `way` [m] from its front, the inverse of
/// stoppingDistance(); 0 where the margin alone is longer.
double safeSpeed(double way, double along, const StopParams& params);

}  // namespace perception
