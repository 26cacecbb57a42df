#pragma once
#include "libperception/measurement/MeasurementModel.h"

namespace perception {

/// The part of an object's outline that lies inside a narrow view: a beam of 15 degrees sees the
/// flank of a passing car long after its nearest corner has left it. Nothing of a neighboring
/// beam's part reaches this sensor.
struct OutlineInView {
  double left = 0,
         right = 0;  ///< [rad] bearings off the sensor's axis, counter-clockwise edge first
  bool left_cut = false, right_cut = false;  ///< by the border of the view
  double range = 0;                          ///< [m] of its nearest point
  Eigen::Matrix<double, 1, 5> range_q = Eigen::Matrix<double, 1, 5>::Zero();  ///< d(range)/dq
  Eigen::RowVector2d range_extent = Eigen::RowVector2d::Zero();  ///< d(range)/d(length, width)
};

/// Cuts `outline`, FootprintModel's prediction of the whole object, to bearings within +-`half`
/// [rad]. Views of half a circle and more, and objects wholly outside, stay as they are.
OutlineInView outlineInView(const AxisPrediction& outline, const Kinematics& object,
                            const Extent& extent, const SensorState& sensor, double half);

}  // namespace perception
