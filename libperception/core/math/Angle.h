#pragma once
#include <cmath>

namespace perception {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kTwoPi = 2 * kPi;

inline constexpr double radians(double degrees) { return degrees * (kPi / 180); }
inline constexpr double degrees(double radians) { return radians * (180 / kPi); }

/// The same direction in (-pi, pi] [rad]; a value that is not finite stays what it is.
inline double wrapAngle(double angle) {
  if (std::abs(angle) < kPi) return angle;  // as most are, and as std::remainder() would, slowly
  const double wrapped = std::remainder(angle, kTwoPi);
  return wrapped <= -kPi ? wrapped + kTwoPi : wrapped;
}

/// The same axis (a line without front or back) in (-pi/2, pi/2] [rad].
inline double wrapAxis(double angle) {
  if (std::abs(angle) < kPi / 2) return angle;
  const double wrapped = std::remainder(angle, kPi);
  return wrapped <= -kPi / 2 ? wrapped + kPi : wrapped;
}

}  // namespace perception
