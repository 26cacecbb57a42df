#pragma once
#include <functional>
#include <string>

#include "libperception/core/Kinematics.h"

namespace perception {

/// A prediction x(after) = f(x) with its slope F = df/dx and the covariance Q of what it leaves
/// out.
struct MotionPrediction {
  Vector4 x;
  Matrix4 F, Q;
};

/// Predicts a state (MotionModel.h) by dt [s]; psd [m^2/s^3] is that of the class, its
/// [class.NAME] accel_psd. Any thread may call.
using MotionFunction = std::function<MotionPrediction(const Vector4& x, double dt, double psd)>;

/// Adds a row to motionModels(); a second function of that name replaces the first. With a heading
/// the state is [x, y, v, theta], and constant velocity predicts until theta is known; without it
/// is [x, y, vx, vy]. Throws Error (kUsage) for a name that a function did not add, and where
/// `has_heading` is not that of the first one.
void addMotionModel(const std::string& name, bool has_heading, MotionFunction predict);

}  // namespace perception
