#pragma once
#include <vector>

#include "libperception/filter/likelihood/Innovation.h"

namespace perception {

/// Kalman update of a class filter (method.md 4): Gaussians and probabilities of all modes, and
/// extent. No change where S is not positive definite.
void updateClassFilter(const Innovation& innovation, ClassFilter& f);

/// Sets the modes' probabilities, at least one in 10^6 each, from logs that need not be normalized,
/// and the moments of the mixture.
void weighModes(std::vector<double> log_mode, ClassFilter& f);

/// The same as updateClassFilter() for a filter of one Gaussian and a position-only measurement, H
/// = (I 0), without the products with zeros; `noise` [m^2]: R_model.
void positionUpdate(const Measurement& m, const Matrix2& noise, ClassFilter& f);

}  // namespace perception
