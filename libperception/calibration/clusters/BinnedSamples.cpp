#include "libperception/calibration/clusters/BinnedSamples.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

/// A value v with a <= v < b, in the middle where floats are dense enough.
float between(float a, float b) {
  const auto middle = static_cast<float>(0.5 * (static_cast<double>(a) + static_cast<double>(b)));
  return middle < b ? middle : a;
}

}  // namespace

BinnedSamples::BinnedSamples(const std::vector<TrainingSample>& samples, std::size_t most)
    : bins(samples.size() * kFeatures), count(samples.size()) {
  tbb::parallel_for(std::size_t{0}, kFeatures, [&](std::size_t f) { bin(samples, f, most); });
}

void BinnedSamples::bin(const std::vector<TrainingSample>& samples, std::size_t f,
                        std::size_t most) {
  std::vector<float> values;
  for (const TrainingSample& s : samples)
    if (std::isfinite((*s.descriptor)[f])) values.push_back((*s.descriptor)[f]);
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  const std::size_t used = std::min(most, values.size());
  std::vector<float>& cuts = thresholds[f];
  for (std::size_t b = 1; b < used; ++b) {
    const std::size_t first = b * values.size() / used;
    cuts.push_back(between(values[first - 1], values[first]));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const float v = (*samples[i].descriptor)[f];
    // As at prediction, what is no number goes right everywhere.
    const auto at = std::isnan(v) ? cuts.end() : std::lower_bound(cuts.begin(), cuts.end(), v);
    bins[f * count + i] = static_cast<std::uint8_t>(at - cuts.begin());
  }
}

}  // namespace perception
