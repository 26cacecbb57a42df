#pragma once
#include "libperception/core/Kinematics.h"
#include "libperception/measurement/Measurement.h"
#include "libperception/measurement/objects/ObjectClass.h"

namespace perception {

/// The extent updated by a partial box (method.md 5.13): a complete side is a measurement of length
/// or width with standard deviation `sigma` [m] or the side's own, an incomplete one is a lower
/// bound of the mean. Sides are assigned to length and width by the angle to the object's `yaw`
/// [rad, world]; between 30 and 60 degrees that is ambiguous and nothing changes. Variances stay
/// above (0.1 m)^2, or a ninth of the side's own variance, because the errors of the boxes of one
/// object are not independent.
Extent updateExtent(const Extent& extent, const PartialBox& sides, double yaw, double sigma);

/// The extent of an object of a class, at most three standard deviations of the class wider than
/// its mean: what a cluster has beside that is spray or a neighbor (method.md 5.13). If clusters
/// are `told_by_shape`, a vehicle is at most four shorter: what is seen then is a part of it.
Extent boundedExtent(Extent extent, const ObjectClass& c, bool told_by_shape);

}  // namespace perception
