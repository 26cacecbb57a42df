#include "libperception/weather/trust/PhantomShare.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libperception/simd/Dispatch.h"

namespace perception {
namespace {

constexpr double kBounds[] = {-7, 2};  // [log-odds] of the correction
constexpr int kBins = 128;             // of log-odds; one more for returns out of range
constexpr float kPerLogOdds = 4, kMiddle = kBins / 2;

double logit(double p) { return std::log(p / (1 - p)); }

PERCEPTION_WIDEST void findBins(const float* __restrict odds, const float* __restrict range,
                                std::size_t count, float reach, std::int32_t* __restrict bins) {
  for (std::size_t s = 0; s < count; ++s) {
    const float place = odds[s] * kPerLogOdds + kMiddle;
    const float low = place > 0 ? place : 0;
    const auto bin = static_cast<std::int32_t>(low < kBins - 1.0F ? low : kBins - 1.0F);
    bins[s] = range[s] <= reach ? bin : kBins;
  }
}

/// Histogram of the log-odds of suspects within `reach` [m].
std::array<std::uint32_t, kBins> countsOf(const SuspectReturns& suspects, float reach) {
  constexpr std::size_t kBlock = 1024, kWays = 4;
  // Most fall into a few bins; four interleaved histograms avoid the dependency.
  std::array<std::array<std::uint32_t, kBins + 1>, kWays> ways{};
  std::array<std::int32_t, kBlock> bins;
  for (std::size_t first = 0; first < suspects.count; first += kBlock) {
    const std::size_t size = std::min(kBlock, suspects.count - first);
    findBins(&suspects.second[first], &suspects.range[first], size, reach, bins.data());
    std::fill(bins.begin() + static_cast<std::ptrdiff_t>(size), bins.end(), kBins);
    for (std::size_t k = 0; k < size; k += kWays)
      for (std::size_t way = 0; way < kWays; ++way)
        ++ways[way][static_cast<std::size_t>(bins[k + way])];
  }
  std::array<std::uint32_t, kBins> counts;
  for (std::size_t b = 0; b < kBins; ++b)
    counts[b] = ways[0][b] + ways[1][b] + ways[2][b] + ways[3][b];
  return counts;
}

}  // namespace

PhantomShare::PhantomShare(const TrustParams& params)
    : adapts_(params.adapt_share),
      fitted_(params.fitted_share),
      range_(params.share_range),
      memory_(params.share_memory),
      gain_(params.share_gain),
      least_(params.least_share),
      share_(params.fitted_share) {}

double PhantomShare::logOdds() const {
  if (!adapts_) return 0;
  const double change = logit(share_) - logit(fitted_);
  return std::clamp(gain_ * change, kBounds[0], kBounds[1]);
}

// Expectation maximization on a histogram of the log-odds.
void PhantomShare::follow(const SuspectReturns& suspects, int near) {
  if (!adapts_ || near == 0) return;
  static const std::array<double, kBins> kSurfaceOdds = [] {  // at bin centers
    std::array<double, kBins> odds{};
    for (int b = 0; b < kBins; ++b)
      odds[static_cast<std::size_t>(b)] =
          std::exp(-(b + 0.5 - static_cast<double>(kMiddle)) / static_cast<double>(kPerLogOdds));
    return odds;
  }();
  const std::array<std::uint32_t, kBins> counts = countsOf(suspects, static_cast<float>(range_));
  double share = started_ ? share_ : fitted_;
  for (int step = 0; step < 30; ++step) {
    const double against = std::exp(logit(fitted_) - logit(share));
    double phantoms = 0;
    for (std::size_t b = 0; b < kBins; ++b)
      phantoms += static_cast<double>(counts[b]) / (1 + kSurfaceOdds[b] * against);
    share = std::clamp(phantoms / near, least_, 0.9);
  }
  const double weight = started_ ? 1 / memory_ : 1;
  share_ += weight * (share - share_);
  started_ = true;
}

}  // namespace perception
