#pragma once
#include <cstddef>

#include "libperception/measurement/Measurement.h"
#include "libperception/measurement/ObjectClass.h"

namespace perception {

/// What a MeasurementModel tells besides whose z is the object's place, (x, y) [m, world], and
/// nothing else: the filter then takes a shorter way to the same numbers.
class PositionOnlyModel {
 public:
  virtual ~PositionOnlyModel() = default;
  /// Covariance [m^2] of z about the place of an object of class c; Measurement::R is added.
  virtual const Matrix2& placeNoise(ClassId c) const = 0;
  /// detectionProbability() of an object of class i at places[i], nothing occluded, for all i below
  /// `count`.
  virtual void placeDetection(const Vector2* places, std::size_t count, const SensorState& sensor,
                              double* out) const = 0;
};

}  // namespace perception
