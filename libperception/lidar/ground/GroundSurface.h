#pragma once
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/lidar/EgoPoints.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Bounds on the deviation of the ground from its plane (crowns, curbs, ramps):
/// [sensor.LABEL.surface]. Assumed (method.md 8.1).
struct SurfaceParams {
  bool local = true;  ///< false: the plane alone, as in [radecki2016]
  int sectors = 120;
  double ring = 2;            ///< [m] depth of a cell
  int cell_points = 3;        ///< least number of returns in a cell
  double quantile = 0.05;     ///< of the heights of a cell's low returns, at most the third lowest
  double step = 0.15;         ///< [m] a curb: change from one cell to the next outward
  double slope = 0.05;        ///< [-] additional change per meter from the last cell with ground
  double max_step = 0.25;     ///< [m] for any gap: less than the ground clearance of cars
  double bound_near = 0.2;    ///< [m] largest distance from the plane at the vehicle
  double bound_slope = 0.03;  ///< [-] growth of that bound with range
  double curvature = 1 / 50.0;  ///< [1/m] of the sharpest vertical curve: growth of that slope
  double steepest = 0.35;  ///< [-] largest slope against the plane: 15 % to either side, 2 degrees

  void visit(ParamVisitor& v);
};

/// Ground height of one scan: the plane plus a bounded deviation that is tracked outward along the
/// beams, sector by sector about the sensor, and linear from cell to cell (method.md 8.1).
class GroundSurface {
 public:
  /// `heights`, unless null, is set to the height of every point above the ground [m]; negative for
  /// mirrored returns.
  GroundSurface(const GroundPlane& plane, const EgoPoints& points, const SurfaceParams& params,
                std::vector<float>* heights = nullptr);

  /// [m] height of the ground at a position, ego frame.
  double heightAt(double x, double y) const;

 private:
  /// Heights of all points above the plane [m], with the places in their rings as their last bits,
  /// and their cells, [sector][ring]; the bitwise complement of the cell for points too high or too
  /// low to be ground.
  void place(const EgoPoints& points, const SurfaceParams& params, std::vector<float>& above,
             std::vector<std::int32_t>& cell) const;
  std::vector<float> lowestOf(const std::vector<float>& above,
                              const std::vector<std::int32_t>& cell,
                              const SurfaceParams& params) const;
  void follow(const std::vector<float>& lowest, const SurfaceParams& params);
  void smooth(const std::vector<float>& borders);
  /// Converts heights above the plane into heights above the ground.
  void subtract(const std::vector<std::int32_t>& cell, std::vector<float>& above) const;

  GroundPlane plane_;
  float sensor_x_, sensor_y_;  ///< [m] center of the cells, ego frame
  std::size_t sectors_ = 1, rings_ = 1;
  float inverse_ring_ = 0, inverse_sector_ = 0;  ///< [1/m, 1/rad]
  /// [m] above the plane at the inner border of a cell, and from there to the outer one;
  /// [sector][ring].
  std::vector<float> departure_, rise_;
};

}  // namespace perception
