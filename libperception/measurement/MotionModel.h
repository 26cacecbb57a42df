#pragma once
#include <deque>
#include <string>

#include "libperception/core/Kinematics.h"

namespace perception {

struct ObjectClass;

/// One Gaussian of a class filter and the step that it takes. State [x, y, vx, vy]; with a heading
/// [x, y, v, theta] once `oriented`; of what does not move [x, y, 0, 0]. World, SI units.
struct GaussianStep {
  Vector4* x;
  Matrix4* P;
  const ObjectClass* object_class;
  double psd, damping;  ///< [m^2/s^3, 1/s] white acceleration and decay of the speed
  double dt;            ///< [s]
  bool oriented;
};

/// The batch kernel that takes the same step as MotionModel::predict (filter/state/BankBatch).
enum class BatchKernel { kNone, kConstantVelocity, kWheeled, kMoments };

/// How the objects of a class move (method.md 3): a row of motionModels(). Whoever needs to know
/// asks for a property of the row, not for its name.
struct MotionModel {
  std::string name;          ///< [class.NAME] motion
  bool moves = true;         ///< false: neither velocity nor heading
  bool has_heading = false;  ///< along its length; unknown at birth unless the sensor tells it
  /// Moves one Gaussian by dt > 0; `transition`, unless null, becomes dx(after)/dx(before).
  void (*predict)(const GaussianStep& step, Matrix4* transition) = nullptr;
  /// What sensors can see of a state: q(x) and its Jacobian.
  Kinematics (*kinematics)(const Vector4& x, bool oriented) = nullptr;
  /// The kernel of a step, kNone where it has to be taken alone; null: always alone.
  BatchKernel (*kernel)(const GaussianStep& step) = nullptr;
};

/// constant-velocity, wheeled, static, and what a program appends before it reads its configuration
/// (not while others read). Rows stay where they are.
std::deque<MotionModel>& motionModels();
/// Null: there is none of that name.
const MotionModel* findMotionModel(const std::string& name);

/// White acceleration through a speed that decays (rate `damping` [1/s]), method.md (4): integrals
/// over the step. Without decay the dt^3/3, dt^2/2, dt.
struct SpeedNoise {
  double decay = 1, effective_dt = 0;  ///< e^(-a dt); integral of it [s]
  double pp = 0, pv = 0, vv = 0;       ///< [s^3, s^2, s] times the power spectral density
  SpeedNoise(double damping, double dt);
};

}  // namespace perception
