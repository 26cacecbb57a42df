#pragma once
#include "libperception/core/Frames.h"
#include "libperception/measurement/models/MeasurementModel.h"

namespace perception {

// The axes of FootprintModel as predicted for one footprint. `d` [m] leads from the sensor to its
// center, `forward` [rad] is the sensor's forward axis; both in the world frame.

inline constexpr double kClearance = 0.05;  // [m] least distance of the sensor from the object

/// The vector rotated by 90 degrees counter-clockwise.
inline Vector2 perpendicular(const Vector2& v) { return {-v.y(), v.x()}; }

/// A disc of diameter (length + width) / 2 (method.md 4.1).
void predictDisc(const Vector2& d, const Extent& extent, double forward, AxisPrediction& out);

/// The oriented rectangle whose corners are rounded by `corner_radius` [m], at most by a quarter of
/// its width: tangents and exact nearest point (method.md 4.1).
void predictRectangle(const Vector2& d, double yaw, const Extent& extent, double corner_radius,
                      double forward, AxisPrediction& out);

}  // namespace perception
