#pragma once
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/lidar/EgoPoints.h"
#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// How far the ground may leave its plane: [sensor.LABEL.surface]. Assumed (method.md 8.1): real
/// roads have crowns, curbs, ramps.
struct SurfaceParams {
  bool local = true;  ///< false: the plane alone, as [radecki2016]
  int sectors = 120;
  double ring = 2;          ///< [m] depth of a cell
  int cell_points = 3;      ///< returns that a cell needs
  double quantile = 0.05;   ///< height of a cell's ground among its low returns, at most the third
  double step = 0.15;       ///< [m] a curb: change from one cell to the next outward
  double slope = 0.05;      ///< [-] further change per meter since the last cell with ground
  double max_step = 0.25;   ///< [m] whatever the gap: below the underside of cars
  double bound_near = 0.2;  ///< [m] largest distance from the plane at the vehicle
  double bound_slope = 0.03;  ///< [-] growth of that bound with range

  void visit(ParamVisitor& v);
};

/// Height of the ground of one scan: the plane and, in each polar cell about the sensor, a bounded
/// departure from it that is followed outward along the beams.
class GroundSurface {
 public:
  /// `heights`, where given, becomes heightsAbove(points).
  GroundSurface(const GroundPlane& plane, const EgoPoints& points, const SurfaceParams& params,
                std::vector<float>* heights = nullptr);

  /// [m] of the ground below a place of the ego frame.
  double heightAt(double x, double y) const;
  /// [m] of every point above the ground; mirrored returns are negative.
  std::vector<float> heightsAbove(const EgoPoints& points) const;

 private:
  /// Heights of all points above the plane [m], and their cells, [sector][ring]; the complement of
  /// it where a point is too high or too low to be of the ground.
  void place(const EgoPoints& points, const SurfaceParams& params, std::vector<float>& above,
             std::vector<std::int32_t>& cell) const;
  std::vector<float> lowestOf(const std::vector<float>& above,
                              const std::vector<std::int32_t>& cell,
                              const SurfaceParams& params) const;
  void follow(const std::vector<float>& lowest, const SurfaceParams& params);
  /// Makes heights above the ground of those above the plane.
  void subtract(const std::vector<std::int32_t>& cell, std::vector<float>& above) const;

  GroundPlane plane_;
  float sensor_x_, sensor_y_;  ///< [m] center of the cells, ego frame
  std::size_t sectors_ = 1, rings_ = 1;
  float inverse_ring_ = 0, inverse_sector_ = 0;  ///< [1/m, 1/rad]
  std::vector<float> departure_;                 ///< [m] above the plane; [sector][ring]
};

}  // namespace perception
