#pragma once
#include "libperception/measurement/models/MeasurementModel.h"

namespace perception {

/// The part of an object's outline inside a narrow field of view: a unit of 15 degrees still sees
/// the side of a passing car after its nearest corner has left the view (method.md 4.3).
struct OutlineInView {
  double left = 0,
         right = 0;  ///< [rad] bearings off the sensor's axis, counter-clockwise edge first
  bool left_cut = false, right_cut = false;  ///< by the border of the view
  double range = 0;                          ///< [m] of the nearest point of that part
  Eigen::Matrix<double, 1, 5> range_q = Eigen::Matrix<double, 1, 5>::Zero();  ///< d(range)/dq
  Eigen::RowVector2d range_extent = Eigen::RowVector2d::Zero();  ///< d(range)/d(length, width)
};

/// Clips `outline`, FootprintModel's prediction of the whole object, to bearings within +-`half`
/// [rad]. Unchanged for half >= pi/2 and for objects entirely outside.
OutlineInView outlineInView(const AxisPrediction& outline, const Kinematics& object,
                            const Extent& extent, const SensorState& sensor, double half);

}  // namespace perception
