#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace perception {

/// Counts trusted and doubted returns in cubes about the sensor: a dark return within a car's body
/// has other company than a flake of the same brightness.
class SurroundingCubes {
 public:
  explicit SurroundingCubes(float reach);  ///< [m] horizontal, from the sensor

  void clear();
  void add(float x, float y, float z, bool doubted) {
    const std::size_t cube = cubeAt(x, y, z);
    std::uint16_t& count = counts_[2 * cube + (doubted ? 1 : 0)];
    count = static_cast<std::uint16_t>(count + (count < 0xFFFF));
  }
  /// ln((1 + trusted) / (1 + doubted)) of the others in the eight cubes that meet nearest to a
  /// place where a return counts as `doubted` itself.
  float company(float x, float y, float z, bool doubted) const;
  std::size_t memoryBytes() const { return counts_.capacity() * sizeof(std::uint16_t); }

 private:
  static constexpr float kEdge = 0.5F;     // [m]
  static constexpr float kBottom = -4.5F;  // [m] of the lowest layer, below a roof lidar's road
  static constexpr int kLayers = 24;

  int along(float v) const {
    const int i = static_cast<int>((v + reach_) * (1 / kEdge));
    return i < 0 ? 0 : i < side_ ? i : side_ - 1;
  }
  static int layer(float z) {
    const int i = static_cast<int>((z - kBottom) * (1 / kEdge));
    return i < 0 ? 0 : i < kLayers ? i : kLayers - 1;
  }
  std::size_t cubeAt(float x, float y, float z) const {
    return static_cast<std::size_t>((along(x) * side_ + along(y)) * kLayers + layer(z));
  }

  float reach_;
  int side_;
  std::vector<std::uint16_t> counts_;  // trusted, doubted of each cube
};

}  // namespace perception
