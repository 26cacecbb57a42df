#include "libperception/weather/state/PrecipitationRate.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

// Law measured with a VLP-16 [linnhoff2022], method.md 9.1, 9.2: returns a beam and mm/h, and the
// shares of its log-normal ranges within 1.5 to 6 m (rain) and 1.5 to 10 m (snow).
constexpr double kRainLaw = 1.69e-4 * 0.597, kSnowLaw = 0.01569 * 0.778;
// Drops [kilic2021], method.md 9.1.
constexpr double kDivergence = 0.003, kFresnel = 0.01985, kWeakest = 0.9 / (200.0 * 200.0);
constexpr double kUsualReach = 200;  // [m] where the data sheet's is not known: (57)
constexpr double kLightest = 0.02, kHeaviest = 300;  // [mm/h] of the table
constexpr std::size_t kRates = 97;
// 90 % limits, as factors (assumed): threshold, divergence and what is behind the air differ by
// instrument and scene.
constexpr double kRainFactor = 2.5, kDropsFactor = 4, kKnownDropsFactor = 2.5, kSnowFactor = 4;
// Of flakes by their brightness: divergence and reflectivity known to a tenth each, which together
// are 1.14 in the diameter and 1.32 in the rate, and what the scene adds.
constexpr double kBrightFactor = 1.35;
// [mm/h] a law that says more was made for another instrument: then the flakes' brightness tells,
// or only limits are known (assumed; heavy snowfall is 2.5, method.md 9.9).
constexpr double kMostSnow = 12, kLeastSnow = 0.3;
constexpr double kFlakeReflectivity = 0.9;  // [hahner2022], method.md 9.2
// The mean echo of flakes of mean diameter D from 1.5 to 2.5 m, over that of one in the middle of
// its beam, is kStrongest - kCovered D / divergence (drawn a million times, method.md 9.10).
constexpr double kStrongest = 1.092, kCovered = 0.285;  // -, [1/m]
// Visibility: reflectivities of usual surfaces and of what is just seen (assumed).
constexpr double kUsual = 0.2, kDull = 0.05, kBright = 0.8;

double rateAt(std::size_t k) {
  return kLightest *
         std::pow(kHeaviest / kLightest, static_cast<double>(k) / static_cast<double>(kRates - 1));
}

// Mean number of drops from 1.5 to 4 m above the threshold in a beam.
double dropsIn(double mm_h, double weakest) {
  const double slope = 4.1 * std::pow(mm_h, -0.21);
  constexpr double kStep = 0.05;
  double sum = 0;
  for (double r = 1.5 + kStep / 2; r < 4; r += kStep) {
    const double beam = r * kDivergence, filled = weakest * r * r / kFresnel;
    if (filled > 1) break;
    const double least = 1e3 * beam * std::sqrt(filled);  // [mm]
    sum += kPi / 4 * beam * beam * 8000 / slope * std::exp(-slope * least) * kStep;
  }
  return sum;
}

Estimate within(double value, double factor) { return {value, value / factor, value * factor}; }

double opticalRange(double reach, double reflectivity) {
  const double margin = std::log(reflectivity / (kWeakest * reach * reach));
  return std::log(20.0) * 2 * reach / std::max(margin, 0.05);
}

}  // namespace

PrecipitationRate::PrecipitationRate() { setReach(0); }

void PrecipitationRate::setReach(double reach) {
  if (reach == reach_) return;
  reach_ = reach;
  const double of = reach > 0 ? reach : kUsualReach;
  drops_.clear();
  for (std::size_t k = 0; k < kRates; ++k) drops_.push_back(dropsIn(rateAt(k), 0.9 / (of * of)));
}

Estimate PrecipitationRate::rain(const AirShares& shares) const {
  return shares.few_far ? byDrops(shares.drops) : within(shares.all / kRainLaw, kRainFactor);
}

// A beam with two drops returns once.
Estimate PrecipitationRate::byDrops(double share) const {
  const double factor = reach_ > 0 ? kKnownDropsFactor : kDropsFactor;
  const double drops = -std::log1p(-std::min(share, 0.99));
  const auto above = std::lower_bound(drops_.begin(), drops_.end(), drops);
  const auto k = static_cast<std::size_t>(above - drops_.begin());
  if (k == 0) return within(kLightest * drops / drops_.front(), factor);
  if (k == kRates) return within(kHeaviest, factor);
  const double part = std::log(drops / drops_[k - 1]) / std::log(drops_[k] / drops_[k - 1]);
  return within(rateAt(k - 1) * std::pow(rateAt(k) / rateAt(k - 1), part), factor);
}

// Snow of Gunn and Marshall's law has about as many flakes in light as in heavy snowfall, and
// larger ones: where the instrument sees nearly all of them, their number says little and their
// echo much.
Estimate PrecipitationRate::snow(const AirShares& shares) const {
  const double by_law = shares.flakes / kSnowLaw;
  if (by_law <= kMostSnow) return within(by_law, kSnowFactor);
  if (shares.brightness <= 0) return {std::sqrt(kLeastSnow * by_law), kLeastSnow, by_law};
  // The smaller root of that echo.
  const double echo = shares.brightness / kFlakeReflectivity;  // [m]
  const double root = std::max(0.0, kStrongest * kStrongest - 4 * kCovered * echo);
  const double diameter =
      1e3 * kDivergence * (kStrongest - std::sqrt(root)) / (2 * kCovered);  // [mm]
  return within(std::pow(2.55 * diameter, 1 / 0.48), kBrightFactor);
}

Estimate visibilityOfReach(double reach) {
  const double r = std::max(reach, 1.0);
  return {opticalRange(r, kUsual), opticalRange(r, kBright), opticalRange(r, kDull)};
}

}  // namespace perception
