#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace perception {

/// What intensities phantoms and surfaces have, learned from scan to scan from what the geometry
/// says: instruments scale them as they like, and some snow is dark and some is bright.
class IntensityLaw {
 public:
  static constexpr std::size_t kBins = 9;
  /// Of intensities in [0, 1]: zero, then octaves of 1/255.
  static std::size_t binOf(float intensity);
  static void findBins(const float* intensity, std::size_t count, std::uint32_t* bins);
  void forget(double share);  ///< [-] of what is known that stays
  /// Returns of a bin, by what they are likely to be.
  void add(std::size_t bin, double phantoms, double surfaces);
  /// [log-odds] per bin; 0 where nothing is known.
  std::array<float, kBins> logRatios() const;

 private:
  std::array<double, kBins> phantoms_{}, surfaces_{};  // [returns]
};

}  // namespace perception
