#pragma once
#include <cstdint>
#include <string>

#include "libperception/evaluation/tables/StudyReport.h"
#include "libperception/sensors/ego/EgoPose.h"
#include "libperception/simulation/world/Scenario.h"

namespace perception {

/// Consistency of the ego pose from GNSS, IMU and wheel odometry.
struct EgoStudyParams {
  Scenario scenario;  ///< with sensors of kind gnss, imu, wheels; other sensors are removed
  std::string name;   ///< of the scenario
  EgoPoseParams ego;
  int runs = 20;        ///< number of Monte Carlo runs
  double warm_up = 10;  ///< [s] excluded from the metrics
  std::uint64_t seed = 1;
};

/// Pose error of a run at one instant and its covariance by the filter.
struct EgoError {
  double t = 0;       ///< [s]
  Vector3 error;      ///< [m, m, rad] x, y, yaw
  Eigen::Matrix3d P;  ///< covariance by the filter
  double nees() const { return error.dot(P.ldlt().solve(error)); }
};

/// Errors of one run, twice a second from the first known heading on.
std::vector<EgoError> runEgo(const EgoStudyParams& params, std::uint64_t seed);

StudyReport egoStudy(const EgoStudyParams& params);

}  // namespace perception
