#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/weather/trust/RangeImage.h"
#include "libperception/weather/trust/SuspectReturns.h"

namespace perception {

/// Largest difference of range of a neighbor from the return's range r for each count: share * r
/// plus a constant.
struct NeighborRules {
  float far;     ///< [m] largest range of the returns
  float tight;   ///< [-] of the range: a neighbor of the same surface
  float wide;    ///< [-] of the range
  float beyond;  ///< [-] of the range: a beam that passes behind
  int surface;   ///< number of the eight nearest within `tight` that makes a return a surface
};

/// Counts the neighbors of near returns. Those stored in the range image are processed eight pixels
/// of a row at a time; hidden ones, whose pixel holds a later return, one by one, and hidden ones
/// of equal range and pixel once.
class NeighborCounter {
 public:
  /// Fills `near.neighbors` of all its returns.
  void count(const RangeImage& image, const NeighborRules& rules, SuspectReturns& near);
  std::size_t memoryBytes() const;

 private:
  std::size_t findHidden(const RangeImage& image, SuspectReturns& near);
  std::size_t deduplicateReturns(std::size_t hidden, const SuspectReturns& near);

  std::vector<std::uint32_t> of_pixel_;    // bits of NeighborCounts
  std::vector<std::uint32_t> hidden_;      // indices of returns that the image does not hold
  std::vector<std::uint32_t> kind_;        // distinct (pixel, range) of each
  std::vector<std::uint32_t> kind_pixel_;  // of each kind
  std::vector<float> kind_range_;          // [m]
  std::vector<std::uint32_t> of_kind_;     // bits of NeighborCounts
};

}  // namespace perception
