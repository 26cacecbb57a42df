#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace perception {

/// Distributions of the intensities of phantoms and surfaces, learned online from the geometric
/// classification: they depend on the instrument's scale and on the kind of snow (method.md 9.6).
class IntensityLaw {
 public:
  static constexpr std::size_t kBins = 9;
  /// Bin of an intensity in [0, 1]: zero, then octaves of 1/255.
  static std::size_t binOf(float intensity);
  static void findBins(const float* intensity, std::size_t count, std::uint32_t* bins);
  void forget(double share);  ///< multiplies the counts by `share` in [0, 1]
  /// Adds expected numbers of phantoms and surfaces to a bin.
  void add(std::size_t bin, double phantoms, double surfaces);
  /// Log-likelihood ratio phantom : surface per bin; 0 without data.
  std::array<float, kBins> logRatios() const;

 private:
  std::array<double, kBins> phantoms_{}, surfaces_{};  // [returns]
};

}  // namespace perception
