#pragma once
#include "libperception/filter/likelihood/Innovation.h"

namespace perception {

/// Kalman update of a class filter (method.md 4): Gaussians and probabilities of all modes, and
/// extent. No change where S is not positive definite.
void updateClassFilter(const Innovation& innovation, ClassFilter& f);

/// The same for a filter of one Gaussian and a position-only measurement, H = (I 0), without the
/// products with zeros; `noise` [m^2]: R_model.
void positionUpdate(const Measurement& m, const Matrix2& noise, ClassFilter& f);

}  // namespace perception
