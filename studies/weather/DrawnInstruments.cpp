#include "studies/weather/DrawnInstruments.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <utility>

#include "libperception/core/math/Random.h"
#include "libperception/simulation/weather/SimulatedWeatherParams.h"

namespace perception {
namespace {

constexpr std::uint32_t kPurpose = 0x696e7374;  // of the random numbers
constexpr double kKnown = 1.1, kHolds = 0.9;    // factor, and how often it holds

/// Standard normal quantiles of `count` equally likely intervals, in random order.
std::vector<double> shuffledQuantiles(std::size_t count, Rng& rng) {
  std::vector<double> out(count);
  const boost::math::normal normal;
  for (std::size_t k = 0; k < count; ++k)
    out[k] = quantile(normal, (static_cast<double>(k) + 0.5) / static_cast<double>(count));
  for (std::size_t k = count; k > 1; --k)
    std::swap(out[k - 1], out[rng.below(static_cast<std::uint32_t>(k))]);
  return out;
}

}  // namespace

std::vector<DrawnInstrument> drawnInstruments(std::size_t count, std::uint64_t seed) {
  Rng rng({seed, 0, 0, kPurpose});
  const std::vector<double> divergence = shuffledQuantiles(count, rng),
                            reflectivity = shuffledQuantiles(count, rng);
  const double sigma = std::log(kKnown) / quantile(boost::math::normal(), 1 - (1 - kHolds) / 2);
  const SimulatedWeatherParams usual;
  std::vector<DrawnInstrument> out(count);
  for (std::size_t k = 0; k < count; ++k) {
    out[k].divergence_mrad = usual.beam_divergence_mrad * std::exp(sigma * divergence[k]);
    out[k].flake_reflectivity =
        std::min(1.0, usual.flake_reflectivity * std::exp(sigma * reflectivity[k]));
  }
  return out;
}

}  // namespace perception
