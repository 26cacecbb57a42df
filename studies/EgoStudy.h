#pragma once
#include <cstdint>
#include <string>

#include "libperception/evaluation/StudyReport.h"
#include "libperception/sensors/EgoPose.h"
#include "libperception/simulation/Scenario.h"

namespace perception {

/// Is the vehicle's own pose, from satellites, inertial unit and wheels, as good as it says?
struct EgoStudyParams {
  Scenario scenario;  ///< with sensors of kind gnss, imu, wheels; its other sensors are left out
  std::string name;   ///< of the scenario
  EgoPoseParams ego;
  int runs = 20;        ///< logs of own noise
  double warm_up = 10;  ///< [s] before figures count
  std::uint64_t seed = 1;
};

/// Errors of a run against the truth at one instant, and what the filter thinks of them.
struct EgoError {
  double t = 0;       ///< [s]
  Vector3 error;      ///< [m, m, rad] x, y, yaw
  Eigen::Matrix3d P;  ///< their covariance by the filter
  double nees() const { return error.dot(P.ldlt().solve(error)); }
};

/// One run, twice a second from the first known heading on.
std::vector<EgoError> runEgo(const EgoStudyParams& params, std::uint64_t seed);

StudyReport egoStudy(const EgoStudyParams& params);

}  // namespace perception
