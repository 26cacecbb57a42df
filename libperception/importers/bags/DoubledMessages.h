#pragma once
#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Tells which messages of a recording are there twice, with the same sensor, stamp and content:
/// recorders that are started twice write each message twice.
class DoubledMessages {
 public:
  /// Whether the same was given before; counts these. Images are never doubles: their pixels are in
  /// files.
  bool isDouble(const SensorFrame& frame);
  /// How many there were, by sensor.
  const std::map<std::string, std::int64_t>& counts() const { return counts_; }

 private:
  /// What a sensor said at its newest stamp, by hashes of the content.
  struct Said {
    Stamp stamp;
    std::set<std::size_t> contents;
  };
  std::map<std::string, Said> said_;
  std::map<std::string, std::int64_t> counts_;
};

}  // namespace perception
