#pragma once
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/ObjectClass.h"

namespace perception {

/// Moves a class filter by dt >= 0 [s] (method.md 3). Motion modes interact first.
void predictClassFilter(const ObjectClass& object_class, double dt, ClassFilter& filter);
/// The parts of it, for batches: makes the modes interact and lists the Gaussians that are left to
/// move by predictGaussian(); combineModes() comes after them.
void listSteps(const ObjectClass& object_class, double dt, ClassFilter& filter,
               std::vector<GaussianStep>& out);
inline void predictGaussian(const GaussianStep& step, Matrix4* transition = nullptr) {
  step.object_class->motion->predict(step, transition);
}

/// What sensors can see of it: q(state) and its Jacobian.
inline Kinematics kinematicsOf(const ObjectClass& object_class, const ClassFilter& filter) {
  return object_class.motion->kinematics(filter.x, filter.oriented);
}

/// Gives a new filter the motion modes of its class, at the shares of time that they take.
void startModes(const ObjectClass& object_class, ClassFilter& filter);
/// x and P of a filter with modes from them: the mixture's mean and spread.
void combineModes(ClassFilter& filter);

/// Gives an unoriented wheeled filter its heading along its velocity: [x, y, vx, vy] -> [x, y, v,
/// theta], with the covariance carried by the Jacobian.
void orientByVelocity(ClassFilter& filter);
/// The same along a known axis: theta is `yaw` or its opposite, whichever the velocity prefers; v
/// is the velocity along.
void orientByAxis(double yaw, double yaw_variance, ClassFilter& filter);
/// The same with a known direction: v may be negative.
void orientAlong(double yaw, double yaw_variance, ClassFilter& filter);
/// The same of a filter that is oriented already: its velocity is kept as far as it lies along.
void reorient(double yaw, double yaw_variance, ClassFilter& filter);
/// A direct measurement of an oriented filter's theta: residual [rad] and variance.
void updateYaw(double y, double variance, ClassFilter& filter);
inline constexpr double kYawGate = 6.635;  ///< chi-square .99, one degree of freedom
/// The exact symmetry (v, theta) -> (-v, theta + pi) of an oriented filter (method.md 7).
void reverse(ClassFilter& filter);

}  // namespace perception
