#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace perception {

/// Indices of the set marks among many, without branches, which would be mispredicted.
class SelectedIndices {
 public:
  static constexpr std::size_t kMost = 256;  ///< marks

  /// `marks`: `count` bytes, a multiple of eight, each 0 or 1.
  void find(const std::uint8_t* marks, std::size_t count) {
    count_ = 0;
    for (std::size_t i = 0; i < count; i += kGroup) {
      // Bytes to bits, eight at a time; bit k is that of byte k.
      constexpr std::uint64_t kToBits = 0x0102040810204080U, kToAll = 0x0101010101010101U;
      std::uint64_t group;
      std::memcpy(&group, marks + i, kGroup);
      const std::uint64_t places = kPlaces[group * kToBits >> 56U] + i * kToAll;
      std::memcpy(&places_[count_], &places, kGroup);
      count_ += group * kToAll >> 56U;
    }
  }
  std::size_t size() const { return count_; }
  const std::uint8_t* begin() const { return places_.data(); }
  const std::uint8_t* end() const { return places_.data() + count_; }

 private:
  static constexpr std::size_t kGroup = 8;

  // For each 8-bit mask the indices of its set bits, in the lowest bytes.
  static constexpr std::array<std::uint64_t, 256> placesByBits() {
    std::array<std::uint64_t, 256> table{};
    for (std::size_t bits = 0; bits < table.size(); ++bits) {
      unsigned left = 0;
      for (std::uint64_t k = 0; k < kGroup; ++k)
        if (bits >> k & 1U) table[bits] |= k << left, left += 8;
    }
    return table;
  }
  static const std::array<std::uint64_t, 256> kPlaces;

  std::size_t count_ = 0;
  std::array<std::uint8_t, kMost + kGroup> places_;
};

inline constexpr std::array<std::uint64_t, 256> SelectedIndices::kPlaces =
    SelectedIndices::placesByBits();

}  // namespace perception
