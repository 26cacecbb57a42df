#pragma once
#include <cstddef>
#include <cstdint>

namespace perception {

/// What columns side by side on the ground keep and take in.
struct FlatEvidence {
  std::uint8_t *weights, *crossed;  ///< of 255; 0 or 1; zero afterwards
  float keep;                       ///< share of the log-odds that is not forgotten
  float hit, miss, low, high;       ///< [log-odds]
  float voided;                     ///< share of voidedBy(): 1 where hits are judged
};

/// Brings the log-odds of `count` columns to the time of a scan and adds what it says.
void addEvidence(float* values, std::size_t count, const FlatEvidence& evidence);

}  // namespace perception
