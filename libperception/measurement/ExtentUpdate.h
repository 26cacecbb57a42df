#pragma once
#include "libperception/core/Kinematics.h"
#include "libperception/measurement/Measurement.h"

namespace perception {

/// The extent after a box was seen (method.md 5.13): a complete side is a measurement of length or
/// width with standard deviation `sigma` [m] or the side's own, an incomplete one only raises a
/// smaller mean. Sides are told apart by the angle to the object's `yaw` [rad, world]; between 30
/// and 60 degrees they cannot be, and nothing changes. Variances keep a floor of (0.1 m)^2, or of a
/// ninth of the side's own, because the errors of one object's boxes are not independent.
Extent updateExtent(const Extent& extent, const PartialBox& sides, double yaw, double sigma);

}  // namespace perception
