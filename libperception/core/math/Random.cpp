#include "libperception/core/math/Random.h"

#include <cmath>

#include <Random123/philox.h>

#include "libperception/core/math/Angle.h"

namespace perception {

Rng::result_type Rng::operator()() {
  if (used_ == words_.size()) {
    // The counter holds (scan, block, slot), the key (seed, purpose): no two streams share a block.
    const std::uint64_t seed =
        key_.seed ^ (static_cast<std::uint64_t>(key_.purpose) * 0x9E3779B97F4A7C15ull);
    const r123::Philox4x32::ctr_type counter = {{static_cast<std::uint32_t>(key_.counter),
                                                 static_cast<std::uint32_t>(key_.counter >> 32),
                                                 key_.slot, block_++}};
    const r123::Philox4x32::key_type key = {
        {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}};
    const auto block = r123::Philox4x32()(counter, key);
    for (unsigned i = 0; i < words_.size(); ++i) words_[i] = block[i];
    used_ = 0;
  }
  return words_[used_++];
}

double Rng::uniform() {
  const std::uint64_t high = (*this)() >> 5;
  const std::uint64_t low = (*this)() >> 6;
  return static_cast<double>((high << 26) | low) * 0x1.0p-53;
}

double Rng::normal() {
  const double radius = std::sqrt(-2 * std::log1p(-uniform()));
  return radius * std::cos(kTwoPi * uniform());
}

double Rng::exponential(double mean) { return -mean * std::log1p(-uniform()); }

int Rng::poisson(double mean) {
  int count = 0;
  while (mean > 30) {  // a sum of Poisson variables is Poisson; avoids underflow of exp(-mean)
    count += poisson(30);
    mean -= 30;
  }
  const double limit = std::exp(-mean);
  for (double product = uniform(); product > limit; product *= uniform()) ++count;
  return count;
}

std::uint32_t Rng::below(std::uint32_t n) {
  const std::uint32_t limit = max() - max() % n;
  std::uint32_t value = (*this)();
  while (value >= limit) value = (*this)();
  return value % n;
}

}  // namespace perception
