#include "libperception/weather/trust/IntensityLaw.h"

#include <algorithm>
#include <cmath>

#include "libperception/simd/Dispatch.h"
#include "libperception/simd/Vector8.h"

namespace perception {
namespace {

constexpr double kPrior = 50;           // [returns] prior count of each bin
constexpr float kBound = 4;             // [log-odds]
constexpr double kFewestPhantoms = 20;  // [returns] least number of phantoms, and of surfaces

/// Number of binary digits of the intensities as bytes, from the exponent of the float.
PERCEPTION_LANES Int8 digitsOf(const Float8& intensity) {
  const Float8 scaled = intensity * 255 + 0.5F;
  const Float8 low = scaled > 0 ? scaled : eight(0.0F);  // NaN becomes 0
  const Float8 bytes = asFloats(truncated(smaller(low, eight(255.0F))));
  return larger((reinterpret_cast<Int8>(bytes) >> 23) - 126, eight(0));
}

PERCEPTION_WIDER void findAll(const float* intensity, std::size_t count, std::uint32_t* bins) {
  for (std::size_t i = 0; i + kLanes <= count; i += kLanes)
    store8(digitsOf(load8(intensity + i)), bins + i);
}

}  // namespace

std::size_t IntensityLaw::binOf(float intensity) {
  return static_cast<std::size_t>(digitsOf(eight(intensity))[0]);
}

void IntensityLaw::findBins(const float* intensity, std::size_t count, std::uint32_t* bins) {
  findAll(intensity, count, bins);
  for (std::size_t i = count / kLanes * kLanes; i < count; ++i)
    bins[i] = static_cast<std::uint32_t>(binOf(intensity[i]));
}

void IntensityLaw::forget(double share) {
  for (auto* counts : {&phantoms_, &surfaces_})
    for (double& count : *counts) count *= share;
}

void IntensityLaw::add(std::size_t bin, double phantoms, double surfaces) {
  phantoms_[bin] += phantoms;
  surfaces_[bin] += surfaces;
}

std::array<float, IntensityLaw::kBins> IntensityLaw::logRatios() const {
  std::array<float, kBins> ratios{};
  double phantoms = 0, surfaces = 0;
  for (std::size_t b = 0; b < kBins; ++b) phantoms += phantoms_[b], surfaces += surfaces_[b];
  if (phantoms < kFewestPhantoms || surfaces < kFewestPhantoms) return ratios;
  for (std::size_t b = 0; b < kBins; ++b) {
    const double pooled = 0.5 * (phantoms_[b] / phantoms + surfaces_[b] / surfaces);
    const double p = (phantoms_[b] + kPrior * pooled) / (phantoms + kPrior);
    const double s = (surfaces_[b] + kPrior * pooled) / (surfaces + kPrior);
    if (p > 0 && s > 0)
      ratios[b] = std::clamp(static_cast<float>(std::log(p / s)), -kBound, kBound);
  }
  return ratios;
}

}  // namespace perception
