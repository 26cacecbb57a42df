#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/weather/RangeImage.h"

namespace perception {

/// How far a neighbour may be off a return's own range r for each count: share * r, and a floor.
struct NeighbourRules {
  float far;     ///< [m] returns beyond are not looked at
  float tight;   ///< [-] of the range: a neighbour of the same surface
  float wide;    ///< [-] of the range
  float beyond;  ///< [-] of the range: a beam that passes behind
  int surface;   ///< of the eight nearest within `tight`: no suspect
};

/// What is in the pixels about a return, RangeImage::kColumnReach columns and kRowReach rows to
/// each side, in one number: six bits a count, so that it can be looked up in a table.
class NeighbourCounts {
 public:
  static constexpr int kBits = 6;
  static constexpr std::uint32_t kMost = 1U << kBits;  ///< no count reaches it

  NeighbourCounts() = default;
  explicit NeighbourCounts(std::uint32_t bits) : bits_(bits) {}
  std::uint32_t tight() const { return bits_ % kMost; }                      ///< within `tight`
  std::uint32_t wide() const { return bits_ >> kBits & (kMost - 1); }        ///< within `wide`
  std::uint32_t beyond() const { return bits_ >> 2 * kBits & (kMost - 1); }  ///< pass behind
  std::uint32_t filled() const { return bits_ >> 3 * kBits & (kMost - 1); }  ///< with a return
  std::uint32_t around() const { return bits_ >> 4 * kBits; }  ///< of the eight nearest, `tight`
  /// beyond() and filled() as one number below kMost^2.
  std::uint32_t beyondAndFilled() const { return bits_ >> 2 * kBits & (kMost * kMost - 1); }

 private:
  std::uint32_t bits_ = 0;
};

/// Returns of the cloud up to `far` that fewer than `surface` of their eight nearest pixels share a
/// surface with, in the scan's order, and what is about each: their number. Both arrays hold as
/// many as there are returns.
std::size_t findSuspects(const RangeImage& image, const NeighbourRules& rules,
                         std::uint32_t* suspects, NeighbourCounts* counts);

}  // namespace perception
