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
  /// Some returns [m, sensor frame] and their ranges [m]: those up to `far` count as trusted.
  void add(const float* x, const float* y, const float* z, const float* range, std::size_t count,
           float far);
  /// One of the returns that were added is a phantom.
  void doubt(float x, float y, float z) {
    const std::size_t cube = columnAt(along(x), along(y)) + static_cast<std::size_t>(layer(z));
    --trusted_[cube], ++doubted_[cube];
  }
  /// ln((1 + trusted) / (1 + doubted)) of the others in the eight cubes that meet nearest to a
  /// place where a return counts as `doubted` itself.
  float company(float x, float y, float z, bool doubted) const;
  std::size_t memoryBytes() const {
    return (trusted_.capacity() + doubted_.capacity()) * sizeof(std::uint32_t);
  }

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

  std::size_t columnAt(int x, int y) const {
    return static_cast<std::size_t>((x * side_ + y) * kLayers);
  }

  float reach_;
  int side_;
  std::vector<std::uint32_t> trusted_, doubted_;  // [returns] of each cube; the last: farther ones
};

}  // namespace perception
