#pragma once
#include <vector>

#include "libperception/measurement/Measurement.h"

namespace perception {

/// Log-odds that `yaw` [rad], an axis of a car's long side, points to the front of the car and not
/// to its rear: the top edge of a car falls towards its hood (method.md 8.6). `places` [m] of the
/// returns in the frame of yaw, `above` [m] their heights over the ground. 0: the returns are too
/// few, show no whole side, or what they show is not as long or as low as a car.
double frontLogOdds(const std::vector<Vector2>& places, const std::vector<double>& above,
                    double yaw);

}  // namespace perception
