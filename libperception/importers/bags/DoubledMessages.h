#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Tells which messages of a recording are there twice, with the same sensor, stamp and content:
/// recorders that are started twice write each message twice.
class DoubledMessages {
 public:
  /// Whether the same was given before; counts these. Images are never doubles: their pixels are in
  /// files.
  /// `resent` [s]: programs that pass messages on may give them a stamp of their own, so a lidar's
  /// scan of 100 returns or more that comes again within this time is a double, too.
  bool isDouble(const SensorFrame& frame, double resent = 0);
  /// How many there were, by sensor.
  const std::map<std::string, std::int64_t>& counts() const { return counts_; }

 private:
  /// What a sensor said just now: hashes of the content, and when.
  using Said = std::map<std::size_t, Stamp>;
  std::map<std::string, Said> said_;
  std::map<std::string, std::int64_t> counts_;
};

}  // namespace perception
