#pragma once
#include <Eigen/Core>

namespace perception {

using Vector4 = Eigen::Matrix<double, 4, 1>;
using Matrix4 = Eigen::Matrix<double, 4, 4>;
using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix54 = Eigen::Matrix<double, 5, 4>;

/// What any sensor can observe of an object, whatever its motion model. The common interface of n
/// measurement models and m motion models, so that no pair of them needs code of its own.
struct Kinematics {
  enum Index { kX, kY, kVx, kVy, kYaw };
  Vector5 q =
      Vector5::Zero();  ///< x, y, vx, vy, yaw of the footprint's center [m, m/s, rad], world
  Matrix54 J = Matrix54::Zero();  ///< dq/dstate; columns beyond the state's size are zero
  bool has_yaw = false;           ///< false: not in the state (pedestrians, poles) or unknown
};

/// Horizontal size of an object as an estimate: static parameters beside the state.
struct Extent {
  double length = 1, width = 1;          ///< [m] along and across yaw
  double var_length = 1, var_width = 1;  ///< [m^2]
};

}  // namespace perception
