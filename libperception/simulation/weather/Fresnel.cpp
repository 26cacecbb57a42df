#include "libperception/simulation/weather/Fresnel.h"

#include <algorithm>
#include <cmath>

namespace perception {

Fresnel waterReflectance(double cos_incidence) {
  constexpr double kAir = 1.0003, kWater = 1.33;
  const double c = std::clamp(cos_incidence, 0.0, 1.0);
  const double sin_inside = kAir / kWater * std::sqrt(1 - c * c);
  const double inside = std::sqrt(1 - sin_inside * sin_inside);
  const double s = (kAir * c - kWater * inside) / (kAir * c + kWater * inside),
               p = (kAir * inside - kWater * c) / (kAir * inside + kWater * c);
  return {s * s, p * p};
}

double filmFactor(double ground, double cos_incidence) {
  const Fresnel r = waterReflectance(cos_incidence);
  const auto through = [&](double reflected) {
    return (1 - reflected) * (1 - reflected) / (1 - ground * reflected);
  };
  return std::max(through(r.across), through(r.along));
}

double wetShare(double film_mm) { return std::clamp(film_mm / 1.2, 0.0, 1.0); }

}  // namespace perception
