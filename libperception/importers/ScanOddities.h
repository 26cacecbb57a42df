#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Finds in lidar scans what drivers write and no lidar measures, takes it out, and counts it.
class ScanOddities {
 public:
  /// The scan without it: no times where they lie outside of the scan (ScanTimes.h), no places of
  /// points that are no returns (NoReturns.h). Empty: the frame has nothing odd, or is no scan.
  std::optional<SensorFrame> mended(const SensorFrame& frame);

  /// A line each for what was left out. Throws DataError: most scans of a lidar lie elsewhere
  /// (NoReturns.h).
  void tell(std::vector<std::string>& notes, std::vector<std::string>& warnings) const;

 private:
  struct Counts {
    std::int64_t scans = 0;
    std::int64_t timeless = 0;    ///< scans, of their times
    std::int64_t no_returns = 0;  ///< points
    std::int64_t elsewhere = 0;   ///< scans whose returns lie elsewhere
  };
  std::map<std::string, Counts> sensors_;
};

}  // namespace perception
