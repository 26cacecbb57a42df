#pragma once
#include "libperception/filter/likelihood/Innovation.h"

namespace perception {

/// A class filter after its object's measurement (method.md 4): the Gaussians of all modes, their
/// probabilities, and the extent. Left alone where S is no covariance.
void updateClassFilter(const Innovation& innovation, ClassFilter& f);

/// The same of a filter of one Gaussian and a measurement of its position alone, without the
/// products with zeros of H = (I 0); `noise` [m^2] is the model's own.
void positionUpdate(const Measurement& m, const Matrix2& noise, ClassFilter& f);

}  // namespace perception
