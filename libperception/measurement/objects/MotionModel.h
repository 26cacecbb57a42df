#pragma once
#include <deque>
#include <string>

#include "libperception/core/Kinematics.h"

namespace perception {

struct ObjectClass;

/// One Gaussian of a class filter and its prediction step. State [x, y, vx, vy]; with a heading [x,
/// y, v, theta] once `oriented`; of a static class [x, y, 0, 0]. World, SI units.
struct GaussianStep {
  Vector4* x;
  Matrix4* P;
  const ObjectClass* object_class;
  double psd, damping;  ///< [m^2/s^3, 1/s] white acceleration and decay of the speed
  double dt;            ///< [s]
  bool oriented;
};

/// The batch kernel with the same result as MotionModel::predict (BankKernels.inl).
enum class BatchKernel { kNone, kConstantVelocity, kWheeled, kMoments };

/// How the objects of a class move (method.md 3): a row of motionModels(). Code depends on the
/// properties of a row, never on its name.
struct MotionModel {
  std::string name;          ///< [class.NAME] motion
  bool moves = true;         ///< false: neither velocity nor heading
  bool has_heading = false;  ///< along its length; unknown at birth unless the sensor measures it
  /// Predicts one Gaussian by dt > 0; sets `transition`, unless null, to F = dx(after)/dx(before).
  void (*predict)(const GaussianStep& step, Matrix4* transition) = nullptr;
  /// Kinematics q(x) and their Jacobian dq/dx.
  Kinematics (*kinematics)(const Vector4& x, bool oriented) = nullptr;
  /// The kernel of a step, kNone where predict() has to be called instead; null: always predict().
  BatchKernel (*kernel)(const GaussianStep& step) = nullptr;
};

/// constant-velocity, wheeled, static, and rows appended by a program, before it reads its
/// configuration (not thread-safe). References to rows stay valid.
std::deque<MotionModel>& motionModels();
/// Null when there is no such name.
const MotionModel* findMotionModel(const std::string& name);

/// Integrals of white acceleration over a step with a speed that decays at the rate `damping`
/// [1/s], method.md (4). Without decay dt^3/3, dt^2/2, dt.
struct SpeedNoise {
  double decay = 1, effective_dt = 0;  ///< e^(-a dt); integral of it [s]
  double pp = 0, pv = 0, vv = 0;       ///< [s^3, s^2, s] times the power spectral density
  SpeedNoise(double damping, double dt);
};

}  // namespace perception
