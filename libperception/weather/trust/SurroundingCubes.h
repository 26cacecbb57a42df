#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace perception {

/// Counts trusted returns and phantoms in cubes of half a meter about the sensor, for the feature
/// TrustFeature::kSurroundings.
class SurroundingCubes {
 public:
  explicit SurroundingCubes(float reach);  ///< [m] horizontal, from the sensor

  void clear();
  /// Cubes of some points [m, sensor frame], below 2^24, and for each the nearest corner of eight
  /// cubes.
  void locate(const float* x, const float* y, const float* z, std::size_t count,
              std::uint32_t* cubes, std::uint32_t* corners) const;
  /// Adds returns as trusted; `mask`: the bits of `cubes` that hold the cube.
  void add(const std::uint32_t* cubes, std::size_t count, std::uint32_t mask);
  /// Turns one of the added returns into a phantom.
  void doubt(std::uint32_t cube) { counts_[cube] += kDoubted - 1; }
  /// ln((1 + trusted) / (1 + doubted)) of the returns in the eight cubes at a corner, except the
  /// return itself, which is counted as `doubted` or trusted.
  float surroundings(std::uint32_t corner, bool doubted) const {
    const std::uint32_t x0 = corner & 1023, x1 = x0 + (corner >> 10 & 3);
    const std::uint32_t y0 = corner >> 12 & 1023, y1 = y0 + (corner >> 22 & 3);
    const std::uint32_t low = corner >> 24 & 31, high = low + (corner >> 29);
    const auto side = static_cast<std::uint32_t>(side_);
    std::uint64_t sum = 0;
    for (const std::uint32_t column :
         {x0 * side + y0, x0 * side + y1, x1 * side + y0, x1 * side + y1})
      sum += counts_[column * kLayers + low] + counts_[column * kLayers + high];
    auto trusted = static_cast<std::uint32_t>(sum), others = static_cast<std::uint32_t>(sum >> 32);
    others -= static_cast<std::uint32_t>(doubted && others > 0);  // not itself
    trusted -= static_cast<std::uint32_t>(!doubted && trusted > 0);
    return logOfOneMore(trusted) - logOfOneMore(others);
  }
  std::size_t memoryBytes() const {
    return counts_.capacity() * sizeof counts_[0] + touched_.capacity();
  }

 private:
  static constexpr float kEdge = 0.5F;     // [m]
  static constexpr float kBottom = -4.5F;  // [m] of the lowest layer: lidar on a roof
  static constexpr std::uint64_t kDoubted = std::uint64_t{1} << 32;
  static constexpr int kLayers = 24;  // fewer than 32, see surroundings()

  float logOfOneMore(std::uint32_t count) const {
    return count < logs_.size() ? logs_[count] : std::log(static_cast<float>(count) + 1);
  }

  static constexpr std::size_t kTogether = 64;  // cubes

  float reach_;
  int side_;
  std::vector<std::uint8_t> touched_;  // of each kTogether cubes: some have returns
  std::vector<std::uint64_t> counts_;  // trusted; in the upper 32 bits phantoms
  std::array<float, 1024> logs_;       // ln(1 + count) for small counts
};

}  // namespace perception
