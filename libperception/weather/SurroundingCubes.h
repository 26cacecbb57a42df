#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace perception {

/// Counts trusted and doubted returns in cubes about the sensor: a dark return within a car's body
/// stands among other returns than a flake of the same brightness.
class SurroundingCubes {
 public:
  explicit SurroundingCubes(float reach);  ///< [m] horizontal, from the sensor

  void clear();
  /// The cubes of some places [m, sensor frame], below 2^24, and, of each, which eight meet
  /// nearest.
  void locate(const float* x, const float* y, const float* z, std::size_t count,
              std::uint32_t* cubes, std::uint32_t* corners) const;
  /// Returns that count as trusted; `mask`: the bits of their cubes.
  void add(const std::uint32_t* cubes, std::size_t count, std::uint32_t mask);
  /// One of the returns that were added is a phantom.
  void doubt(std::uint32_t cube) { counts_[cube] += kDoubted - 1; }
  /// ln((1 + trusted) / (1 + doubted)) of the others in the eight cubes at a corner, where a return
  /// counts as `doubted` itself.
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
  std::size_t memoryBytes() const { return counts_.capacity() * sizeof counts_[0]; }

 private:
  static constexpr float kEdge = 0.5F;     // [m]
  static constexpr float kBottom = -4.5F;  // [m] of the lowest layer, below a roof lidar's road
  static constexpr std::uint64_t kDoubted = std::uint64_t{1} << 32;
  static constexpr int kLayers = 24;  // fewer than 32, see surroundings()

  float logOfOneMore(std::uint32_t count) const {
    return count < logs_.size() ? logs_[count] : std::log(static_cast<float>(count) + 1);
  }

  float reach_;
  int side_;
  std::vector<std::uint64_t> counts_;  // [returns] of each cube: trusted; above, doubted
  std::array<float, 1024> logs_;       // ln(1 + count), where counts are as usual
};

}  // namespace perception
