#pragma once
#include "libperception/filter/likelihood/Innovation.h"

namespace perception {

/// Kalman update of a class filter (method.md 4): Gaussians and probabilities of all modes, and
/// extent. No change where S is not positive definite.
void kalmanUpdate(const Innovation& innovation, ClassFilter& f);

/// The same for a filter of one Gaussian and a position-only measurement; `noise` [m^2]: R_model.
void placeUpdate(const Measurement& m, const Matrix2& noise, ClassFilter& f);

}  // namespace perception
