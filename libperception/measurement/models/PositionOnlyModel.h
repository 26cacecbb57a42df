#pragma once
#include <cstddef>

#include "libperception/measurement/Measurement.h"
#include "libperception/measurement/objects/ObjectClass.h"

namespace perception {

/// Further interface of a MeasurementModel whose z is the object's position (x, y) [m, world] and
/// nothing else: the filter has shorter code with the same results for it (method.md 4.4).
class PositionOnlyModel {
 public:
  virtual ~PositionOnlyModel() = default;
  /// Covariance [m^2] of z about the position of an object of class c; Measurement::R is added.
  virtual const Matrix2& placeNoise(ClassId c) const = 0;
  /// detectionProbability() of an object of class i at places[i], nothing occluded, for all i below
  /// `count`.
  virtual void placeDetection(const Vector2* places, std::size_t count, const SensorState& sensor,
                              double* out) const = 0;
};

}  // namespace perception
