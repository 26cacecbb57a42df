#pragma once
#include "libperception/config/ParamSet.h"
#include "libperception/grid/way/FreeDistance.h"

namespace perception {

/// The vehicle that carries the sensors: [vehicle].
struct VehicleParams {
  /// [m] of its highest point above the ground. If it is 0, the height of the highest lidar counts,
  /// but at least 1.7 m (assumed: a car).
  double height = 0;

  void visit(ParamVisitor& v);
};

/// When the vehicle should stop for what the grid shows on its path: [grid.stop]. The advice itself
/// is SafetyMonitor::advise() (pipeline/safety, method.md 8.4). All values are assumed.
struct StopParams {
  VehicleParams vehicle;
  double clearance = 0.3;   ///< [m] to keep below what hangs, for springs and errors of heights
  double width = 2.2;       ///< [m] of the corridor: a car and .2 m on each side
  double reaction = 0.5;    ///< [s] from a scan to full braking
  double deceleration = 4;  ///< [m/s^2] of firm braking on a wet road
  double margin = 1;        ///< [m] to keep in front of the obstacle
  /// [m] length of the path that is checked. It is longer if the stopping distance is longer.
  double look_ahead = 80;
  double reverses_above = 0.2;  ///< [m/s] backward speed from which the path behind is checked
  double steers_above = 1;      ///< [m/s] below this speed the path is taken as straight
  double sharpest = 0.2;        ///< [1/m] largest curvature of the path: a car's sharpest turn
  int cells = 3;                ///< occupied cells within half a meter that make an obstacle
  /// [m] by which an object's outline grows before the cells inside count as its own: two cells.
  double obstacle_grow = 0.4;
  double returns = 10;  ///< returns of one scan, by their weights, that make an obstacle as well

  void visit(ParamVisitor& v);
};

/// Whether the vehicle drives backward. `velocity` [m/s] is in the world frame.
bool isReversing(const Pose3& T_world_ego, const Vector2& velocity, const StopParams& params);

/// The corridor along the arc that the vehicle drives at this instant: ahead, or behind it while it
/// reverses. It is at least as long as the stopping distance. `velocity` [m/s] is in the world
/// frame, `yaw_rate` is in [rad/s], and `front` and `rear` [m], both positive, are the distances of
/// the vehicle's ends from the ego origin.
Corridor drivenCorridor(const Pose3& T_world_ego, const Vector2& velocity, double yaw_rate,
                        double front, double rear, const StopParams& params);

/// The distance [m] from the vehicle's front, or its rear while it reverses, within which an
/// obstacle calls for braking: v t + v^2 / (2 a) + margin, where v is `speed`, t `reaction` and a
/// `deceleration`. At 20 m/s that is 61 m. If the obstacle drives away at v_o = `along` > 0 [m/s],
/// the distance v_o^2 / (2 a) that it still covers when it brakes as hard is subtracted; one that
/// comes nearer counts as standing. The result is never below the margin.
double stoppingDistance(double speed, double along, const StopParams& params);

/// The speed [m/s] from which the vehicle can stop within `way` [m] of that end: the inverse of
/// stoppingDistance(). It is 0 if the margin alone is longer than `way`.
double safeSpeed(double way, double along, const StopParams& params);

}  // namespace perception
