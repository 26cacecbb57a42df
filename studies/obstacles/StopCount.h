#pragma once
#include <cstddef>
#include <optional>

#include "libperception/core/Time.h"

namespace perception {

/// Whether something real is in the way at one instant.
enum class InTheWay {
  kNo,       ///< nothing real within the stopping distance and a meter
  kPerhaps,  ///< at its border, or for less than three scans
  kYes       ///< clearly within the stopping distance for three scans
};

/// Stops that a monitor of the driven path calls for, against what is there. Scans in a row, apart
/// by at most half a second, are one stop.
class StopCount {
 public:
  void add(Stamp stamp, bool stop, InTheWay real);
  StopCount& operator+=(const StopCount& other);

  struct Runs {
    std::size_t scans = 0, stops = 0;
  };
  Runs rightly;  ///< stop, and something is in the way
  Runs falsely;  ///< stop, and nothing is
  Runs missed;   ///< no stop, though something is

 private:
  static void count(Runs& runs, std::optional<Stamp>& last, Stamp stamp);
  std::optional<Stamp> last_rightly_, last_falsely_, last_missed_;
};

}  // namespace perception
