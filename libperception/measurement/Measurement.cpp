#include "libperception/measurement/Measurement.h"

namespace perception {

void scaleNoise(Measurement& measurement, double factor) {
  Measurement& m = measurement;
  m.R *= factor * factor;
  m.position_sigma *= factor;
  if (m.base_z) m.base_z->variance *= factor * factor;
  if (m.height) m.height->variance *= factor * factor;
  if (m.sides)
    m.sides->yaw_sigma *= factor, m.sides->length_sigma *= factor, m.sides->width_sigma *= factor;
  if (m.heading) m.heading->sigma *= factor;
}

}  // namespace perception
