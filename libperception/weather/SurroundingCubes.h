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
  /// The points that add() is about.
  void place(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z);
  void add(std::size_t i, bool doubted) {
    std::uint16_t& count = counts_[2 * cube_of_[i] + (doubted ? 1 : 0)];
    count = static_cast<std::uint16_t>(count + (count < 0xFFFF));
  }
  /// ln((1 + trusted) / (1 + doubted)) of the others in the eight cubes that meet nearest to a
  /// place where a return counts as `doubted` itself.
  float company(float x, float y, float z, bool doubted) const;
  std::size_t memoryBytes() const {
    return counts_.capacity() * sizeof(std::uint16_t) + cube_of_.capacity() * sizeof(std::uint32_t);
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

  float reach_;
  int side_;
  std::vector<std::uint16_t> counts_;  // trusted, doubted of each cube
  std::vector<std::uint32_t> cube_of_;
};

}  // namespace perception
