#include "libperception/simulation/weather/surfaces/Fresnel.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

// From air onto a medium of a refractive index.
Fresnel reflectance(double cos_incidence, double index) {
  constexpr double kAir = 1.0003;
  const double c = std::clamp(cos_incidence, 0.0, 1.0);
  const double sin_inside = kAir / index * std::sqrt(1 - c * c);
  const double inside = std::sqrt(1 - sin_inside * sin_inside);
  const double s = (kAir * c - index * inside) / (kAir * c + index * inside),
               p = (kAir * inside - index * c) / (kAir * inside + index * c);
  return {s * s, p * p};
}

}  // namespace

Fresnel waterReflectance(double cos_incidence) { return reflectance(cos_incidence, 1.33); }

double glassReflectance(double cos_incidence) {
  const auto pane = [](double surface) { return 2 * surface / (1 + surface); };
  const Fresnel r = reflectance(cos_incidence, 1.52);
  return .5 * (pane(r.across) + pane(r.along));
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
