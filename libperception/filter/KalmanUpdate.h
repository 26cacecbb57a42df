#pragma once
#include "libperception/filter/Innovation.h"

namespace perception {

/// A class filter after its object's measurement (SPEC 4): the Gaussians of all modes, their
/// probabilities, and the extent. Left alone where S is no covariance.
void kalmanUpdate(const Innovation& innovation, ClassFilter& f);

}  // namespace perception
