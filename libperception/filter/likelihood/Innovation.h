#pragma once
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/models/MeasurementModel.h"

namespace perception {

/// Innovation y and covariance S of one class filter on the axes seen (n rows), and H = dh/dstate
/// (n x 4). Motion modes share h and H, evaluated at the class filter's mean (method.md 4).
struct Innovation {
  AxisVector y;
  AxisMatrix S;
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::ColMajor, kMaxAxes, 4> H;
  Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::ColMajor, kMaxAxes, 2>
      H_extent;  ///< dh/d(length, width); zero rows where the axis does not correct the extent
  AxisMatrix R;  ///< measurement noise, extent uncertainty included

  AxisVector residualOf(const ModeFilter& mode, const ClassFilter& filter) const;
  AxisMatrix covarianceOf(const Matrix4& P) const;  ///< S for another P
};
Innovation innovationOf(const ClassFilter& filter, const Kinematics& kinematics,
                        const AxisPrediction& prediction, const Measurement& m,
                        const MeasurementModel& model);

}  // namespace perception
