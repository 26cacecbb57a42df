#pragma once
#include <cmath>
#include <cstdint>
#include <deque>
#include <utility>

#include "libperception/core/Time.h"

namespace perception {

/// Frame numbers of the log for recent stamps.
class FrameNumbers {
 public:
  void add(Stamp stamp, std::int64_t number) {
    numbers_.emplace_back(stamp, number);
    if (numbers_.size() > kKept) numbers_.pop_front();
  }
  /// The last added number within kSameInstant of the stamp; -1: none.
  std::int64_t at(Stamp stamp) const {
    for (auto it = numbers_.rbegin(); it != numbers_.rend(); ++it) {
      if (std::abs(stamp - it->first) <= kSameInstant) return it->second;
    }
    return -1;
  }
  void clear() { numbers_.clear(); }

 private:
  static constexpr std::size_t kKept = 200;
  static constexpr double kSameInstant = 1e-3;  ///< [s] largest difference between the stamps of a
                                                ///< frame and of the entry with its number
  std::deque<std::pair<Stamp, std::int64_t>> numbers_;
};

}  // namespace perception
