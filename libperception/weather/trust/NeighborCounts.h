#pragma once
#include <cstdint>

namespace perception {

/// Counts of neighbors in the pixels about a return, RangeImage::kColumnReach columns and kRowReach
/// rows to each side, packed in one number with six bits per count, so that tables can be indexed
/// by it.
class NeighborCounts {
 public:
  static constexpr int kBits = 6;
  static constexpr std::uint32_t kMost = 1U << kBits;  ///< no count reaches it

  NeighborCounts() = default;
  explicit NeighborCounts(std::uint32_t bits) : bits_(bits) {}
  std::uint32_t tight() const { return bits_ % kMost; }                      ///< within `tight`
  std::uint32_t wide() const { return bits_ >> kBits & (kMost - 1); }        ///< within `wide`
  std::uint32_t beyond() const { return bits_ >> 2 * kBits & (kMost - 1); }  ///< pass behind
  std::uint32_t filled() const { return bits_ >> 3 * kBits & (kMost - 1); }  ///< with a return
  std::uint32_t around() const { return bits_ >> 4 * kBits; }  ///< of the eight nearest, `tight`

 private:
  std::uint32_t bits_ = 0;
};

}  // namespace perception
