#pragma once
#include <cstdint>

namespace perception {

/// An instant in nanoseconds since 1970-01-01T00:00:00 UTC. An integer, so that equal instants
/// compare equal.
struct Stamp {
  std::int64_t ns = 0;  ///< [ns]

  static Stamp fromSeconds(double seconds) {
    return {static_cast<std::int64_t>(seconds * 1e9 + (seconds < 0 ? -0.5 : 0.5))};
  }
  double seconds() const { return static_cast<double>(ns) * 1e-9; }  ///< [s] to about 0.2 us

  friend bool operator==(Stamp a, Stamp b) { return a.ns == b.ns; }
  friend bool operator!=(Stamp a, Stamp b) { return a.ns != b.ns; }
  friend bool operator<(Stamp a, Stamp b) { return a.ns < b.ns; }
  friend bool operator<=(Stamp a, Stamp b) { return a.ns <= b.ns; }
  friend bool operator>(Stamp a, Stamp b) { return a.ns > b.ns; }
  friend bool operator>=(Stamp a, Stamp b) { return a.ns >= b.ns; }
};

/// later - earlier [s].
inline double operator-(Stamp later, Stamp earlier) {
  return static_cast<double>(later.ns - earlier.ns) * 1e-9;
}
inline Stamp operator+(Stamp t, double seconds) { return {t.ns + Stamp::fromSeconds(seconds).ns}; }

}  // namespace perception
