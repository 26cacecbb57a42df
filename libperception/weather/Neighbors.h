#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/weather/RangeImage.h"
#include "libperception/weather/SuspectReturns.h"

namespace perception {

/// How far a neighbor may be off a return's own range r for each count: share * r, and a floor.
struct NeighborRules {
  float far;     ///< [m] returns beyond are not looked at
  float tight;   ///< [-] of the range: a neighbor of the same surface
  float wide;    ///< [-] of the range
  float beyond;  ///< [-] of the range: a beam that passes behind
  int surface;   ///< of the eight nearest within `tight`: no suspect
};

/// Counts what is about near returns. Those that a range image shows are counted eight pixels of a
/// row at once; the others, which shared their pixel with a later one, each by itself, and those at
/// one range in one pixel (echoes that are one) once.
class NeighborCounter {
 public:
  /// Fills `neighbors` of all returns that are there.
  void count(const RangeImage& image, const NeighborRules& rules, SuspectReturns& near);
  std::size_t memoryBytes() const;

 private:
  std::size_t findHidden(const RangeImage& image, SuspectReturns& near);
  std::size_t deduplicateReturns(std::size_t hidden, const SuspectReturns& near);

  std::vector<std::uint32_t> of_pixel_;    // bits of NeighborCounts
  std::vector<std::uint32_t> hidden_;      // returns that the image does not show
  std::vector<std::uint32_t> kind_;        // of each of them
  std::vector<std::uint32_t> kind_pixel_;  // of each kind
  std::vector<float> kind_range_;          // [m]
  std::vector<std::uint32_t> of_kind_;     // bits of NeighborCounts
};

}  // namespace perception
