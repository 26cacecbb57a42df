#pragma once
#include <cmath>
#include <cstddef>

#include "libperception/core/Angle.h"
#include "libperception/core/ObjectClass.h"
#include "libperception/measurement/Measurement.h"

namespace perception {

/// What a MeasurementModel tells besides whose z is the object's place, (x, y) [m, world], and
/// nothing else: the filter then takes a shorter way to the same numbers.
class PlaceSight {
 public:
  virtual ~PlaceSight() = default;
  /// Covariance [m^2] of z about the place of an object of class c; Measurement::R is added.
  virtual const Matrix2& placeNoise(ClassId c) const = 0;
  /// detectionProbability() of an object of class i at places[i], nothing hidden, for all i below
  /// `count`.
  virtual void placeDetection(const Vector2* places, std::size_t count, const SensorState& sensor,
                              double* out) const = 0;
};

/// Half of a field of view, its sine and cosine taken once.
struct HalfAngle {
  explicit HalfAngle(double angle)
      : cosine(std::cos(angle)), sine(std::sin(angle)), all(angle >= kPi) {}
  double cosine, sine;
  bool all;  ///< the full circle
};
/// touchesSector() for a field of view that many discs are held against.
bool touchesSector(const Vector2& centre, double reach, const HalfAngle& half_fov, double range,
                   const SensorState& sensor);

}  // namespace perception
