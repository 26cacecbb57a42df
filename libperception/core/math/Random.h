#pragma once
#include <array>
#include <cstdint>

namespace perception {

/// Identifies one stream of random numbers. Streams of different keys are independent, in whatever
/// order they are used.
struct RngKey {
  std::uint64_t seed = 0;     ///< of the whole run
  std::uint64_t counter = 0;  ///< which scan, frame, ...
  std::uint32_t slot = 0;     ///< which hypothesis, beam, ...
  std::uint32_t purpose = 0;  ///< a constant per use, so that uses do not share numbers

  RngKey withSlot(std::uint32_t s) const { return {seed, counter, s, purpose}; }
  RngKey withPurpose(std::uint32_t p) const { return {seed, counter, slot, p}; }
};

/// Counter-based generator (Philox4x32-10 [salmon2011], from Random123; method.md 1.5): a function
/// of key and index only, hence the same on every machine and for every number of threads. Also a
/// UniformRandomBitGenerator.
class Rng {
 public:
  using result_type = std::uint32_t;
  explicit Rng(const RngKey& key) : key_(key) {}

  result_type operator()();
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return 0xffffffffu; }

  double uniform();  ///< in [0, 1), 53 bits
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double normal();  ///< mean 0, variance 1 (Box-Muller)
  double normal(double mean, double sigma) { return mean + sigma * normal(); }
  double exponential(double mean);
  int poisson(double mean);
  std::uint32_t below(std::uint32_t n);  ///< in [0, n), unbiased

 private:
  RngKey key_;
  std::uint32_t block_ = 0;
  unsigned used_ = 4;
  std::array<std::uint32_t, 4> words_{};
};

}  // namespace perception
