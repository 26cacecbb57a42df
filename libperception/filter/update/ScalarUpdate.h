#pragma once
#include "libperception/measurement/Measurement.h"

namespace perception {

/// Kalman update of a scalar x by a direct measurement z of it.
inline void scalarUpdate(const ScalarEstimate& z, ScalarEstimate& x) {
  const double gain = x.variance / (x.variance + z.variance);
  x.mean += gain * (z.mean - x.mean);
  x.variance *= 1 - gain;
}

}  // namespace perception
