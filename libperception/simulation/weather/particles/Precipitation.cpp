#include "libperception/simulation/weather/particles/Precipitation.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

// Extinction efficiencies at 905 nm by Mie theory (computed): water 2.0 to 2.06, ice 2.0.
constexpr double kWaterEfficiency = 2.03, kIceEfficiency = 2.0;

}  // namespace

SizeDistribution marshallPalmer(double rain_mm_h) {
  return {8000, 4.1 * std::pow(rain_mm_h, -0.21)};
}

SizeDistribution gunnMarshall(double snow_mm_h) {
  return {7600 * std::pow(snow_mm_h, -0.87), 2.55 * std::pow(snow_mm_h, -0.48)};
}

SizeDistribution flakeSizes(double snow_mm_h) {
  const SizeDistribution melted = gunnMarshall(snow_mm_h);
  const double growth = std::cbrt(1 / kFlakeDensity);
  return {melted.number / growth, melted.slope / growth};
}

double dropSpeed(double diameter) { return std::max(0.0, 9.65 - 10.3 * std::exp(-.6 * diameter)); }

// The integral of D^2 exp(-slope D) is 2 / slope^3 [mm^3]; 1e-6: mm^2 as m^2.
double extinction(const SizeDistribution& sizes, double efficiency) {
  return kPi / 4 * 1e-6 * efficiency * sizes.number * 2 / std::pow(sizes.slope, 3);
}

double rainExtinction(double rain_mm_h) {
  return rain_mm_h > 0 ? extinction(marshallPalmer(rain_mm_h), kWaterEfficiency) : 0;
}

double snowExtinction(double snow_mm_h) {
  return snow_mm_h > 0 ? extinction(gunnMarshall(snow_mm_h), kIceEfficiency) : 0;
}

double radarAttenuation(double rain_mm_h) { return 1.132 * std::pow(rain_mm_h, 0.718); }

double radarBackscatter(double rain_mm_h) {
  return rain_mm_h > 0 ? 1.156e-4 * std::pow(rain_mm_h, 0.714) : 0;
}

// At range r the least diameter is divergence r^2 / reference_range, and the beam's section is
// pi/4 (divergence r)^2: the density of range is proportional to r^2 exp(-a r^2).
DetectableParticles::DetectableParticles(const SizeDistribution& sizes, double divergence,
                                         double reference_range) {
  const double slope = 1000 * sizes.slope;  // [1/m]
  const double a = slope * divergence / reference_range;
  const double per_m3 = sizes.number / sizes.slope;
  mean = per_m3 * kPi / 4 * divergence * divergence * std::sqrt(kPi) / 4 * std::pow(a, -1.5);
  scale = std::sqrt(.5 / a);
}

// The square of the range has a chi-squared distribution of 3 degrees of freedom: of 2 and of 1.
double DetectableParticles::range(Rng& rng) const {
  const double normal = rng.normal();
  return scale * std::sqrt(rng.exponential(2) + normal * normal);
}

double FalseReturnLaw::chance(double mm_h) const { return std::min(1.0, per_mm_h * mm_h); }

double FalseReturnLaw::range(Rng& rng) const { return std::exp(rng.normal(log_mean, log_sigma)); }

double FalseReturnLaw::shareWithin(double m) const {
  return .5 * std::erfc((log_mean - std::log(m)) / (log_sigma * std::sqrt(2.0)));
}

}  // namespace perception
