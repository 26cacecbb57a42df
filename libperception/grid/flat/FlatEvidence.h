#pragma once
#include <cstddef>
#include <cstdint>

namespace perception {

/// Evidence of a scan for contiguous columns of a 2D grid.
struct FlatEvidence {
  std::uint8_t *weights, *crossed;  ///< in units of 1 / 255; 0 or 1; both cleared by addEvidence()
  float keep;                       ///< factor of decay of the log-odds
  float hit, miss, low, high;       ///< [log-odds]
  float voided;                     ///< factor of voidedBy(): 1 with weights of hits, else 0
};

/// Decays the log-odds of `count` columns to the time of a scan and adds its evidence.
void addEvidence(float* values, std::size_t count, const FlatEvidence& evidence);

}  // namespace perception
