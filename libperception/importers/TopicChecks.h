#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// What recorders get wrong within one topic, found message by message in the order of the
/// recording: time that jumps back, two sensors on one topic, returns that are timed seconds
/// outside of their scan. Each is mended or left out, counted and said.
class TopicChecks {
 public:
  /// Looks at a message of `topic`, whose header names the frame of reference `reference`, and
  /// mends it. False: leave it out, since the topic has been at this time before.
  bool take(const std::string& topic, const std::string& reference, SensorFrame& frame);
  /// Whether `reference` is the first one that the topic had.
  bool isFirstReference(const std::string& topic, const std::string& reference) const;
  /// A sentence for each fault of each topic.
  std::vector<std::string> warnings() const;

 private:
  struct Topic {
    std::vector<std::string> references;        ///< in order of appearance
    std::map<std::string, Stamp> newest;        ///< by frame of reference
    std::int64_t messages = 0;                  ///< so far
    std::int64_t before = 0, first_before = 0;  ///< left out: how many, number of the first
    double jump = 0;                            ///< [s] the greatest step back
    std::int64_t untimed = 0;                   ///< scans whose returns' times were left out
    double outside = 0;                         ///< [s] the greatest of these times
    std::string label;                          ///< of the sensor
  };
  std::map<std::string, Topic> topics_;
};

}  // namespace perception
