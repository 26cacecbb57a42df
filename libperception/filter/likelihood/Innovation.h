#pragma once
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/MeasurementModel.h"

namespace perception {

/// Innovation and its covariance of one class filter for the axes seen, and H = dh/dstate. Motion
/// modes share h and H, taken at the class filter's mean.
struct Innovation {
  AxisVector y;
  AxisMatrix S;
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::ColMajor, kMaxAxes, 4> H;
  Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::ColMajor, kMaxAxes, 2>
      H_extent;  ///< dh/d(length, width), rows that do not correct the extent zero
  AxisMatrix R;  ///< measurement noise, extent uncertainty included

  AxisVector residualOf(const ModeFilter& mode, const ClassFilter& filter) const;
  AxisMatrix covarianceOf(const Matrix4& P) const;  ///< S for another P
};
Innovation innovationOf(const ClassFilter& filter, const Kinematics& kinematics,
                        const AxisPrediction& prediction, const Measurement& m,
                        const MeasurementModel& model);

}  // namespace perception
