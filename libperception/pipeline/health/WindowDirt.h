#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Directions below a lidar in which the road lies, 1 deg apart: those that never return although
/// their neighbors do are dirt on its window (method.md 9.10).
class WindowDirt {
 public:
  void add(const LidarCloud& cloud, Stamp stamp);
  /// [0, 1] share of the directions without a return in the last second, between others that have
  /// some; empty while less than that is known.
  std::optional<double> share() const;
  /// Returns of the last scan in these directions, of those that were looked at.
  std::size_t returns() const { return returns_; }

 private:
  static constexpr std::size_t kColumns = 360, kRows = 12;
  std::optional<Stamp> first_;
  Stamp last_;
  std::size_t scans_ = 0, returns_ = 0;
  std::array<std::int64_t, kColumns * kRows> seen_{};  ///< [ns] of the last return; 0: never
};

}  // namespace perception
