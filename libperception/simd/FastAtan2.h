#pragma once
#include <cmath>

namespace perception {

/// atan2(y, x) within 3e-4 rad [rad], without calls and branches, so that the compiler vectorizes
/// loops over returns. For selecting sectors, not for measuring. Abramowitz and Stegun 4.4.49, four
/// terms.
inline float fastAtan2(float x, float y) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float high = ax > ay ? ax : ay, low = ax > ay ? ay : ax;
  const float t = low / (high + 1e-30f), s = t * t;
  float angle =
      t * (0.9998660f + s * (-0.3302995f + s * (0.1801410f + s * (-0.0851330f + s * 0.0208351f))));
  angle = ay > ax ? 1.57079633f - angle : angle;
  angle = x < 0 ? 3.14159265f - angle : angle;
  return y < 0 ? -angle : angle;
}

/// atan2(y, x) within 1e-6 rad [rad], vectorizable like fastAtan2(). Abramowitz and Stegun 4.4.49
/// and what rounding adds.
inline float closeAtan2(float x, float y) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float high = ax > ay ? ax : ay, low = ax > ay ? ay : ax;
  const float t = low / (high + 1e-30f), s = t * t;
  float series = 0.0028662257f;
  series = series * s - 0.0161657367f, series = series * s + 0.0429096138f;
  series = series * s - 0.0752896400f, series = series * s + 0.1065626393f;
  series = series * s - 0.1420889944f, series = series * s + 0.1999355085f;
  series = series * s - 0.3333314528f;
  float angle = t + t * (s * series);
  angle = ay > ax ? 1.57079633f - angle : angle;
  angle = x < 0 ? 3.14159265f - angle : angle;
  return y < 0 ? -angle : angle;
}

}  // namespace perception
