#pragma once
#include <array>
#include <cstddef>

namespace perception {

/// Why a return is doubted (trust below one half): the part of its log-odds that is the largest
/// (method.md 9.13), or the test for mirror images.
enum class DoubtCause {
  kIsolated,       ///< few neighbors for its range and height, and the share of phantoms
  kIntensity,      ///< an intensity that phantoms have more often
  kAmongPhantoms,  ///< more phantoms than surfaces within half a meter
  kSensorLabel,    ///< the sensor's own verdict: rain or dirt
  kEcho,           ///< the first of two echoes, weaker or shorter than the second
  kMirror          ///< a mirror image in a wet road
};
constexpr std::size_t kDoubtCauses = 6;
/// As result files have them.
inline constexpr std::array<const char*, kDoubtCauses> kDoubtCauseNames = {
    "isolated", "intensity", "among_phantoms", "sensor_label", "echo", "mirror"};

/// Why one return is doubted.
struct Doubt {
  DoubtCause cause = DoubtCause::kIsolated;
  double evidence = 0;  ///< [log-odds] of the cause; 0 for kMirror, which is a test
};

/// The log-odds of a return by cause, without kMirror; their sum is that of its trust.
struct OddsParts {
  std::array<float, kDoubtCauses - 1> of{};  ///< [log-odds] index as DoubtCause

  float& operator[](DoubtCause cause) { return of[static_cast<std::size_t>(cause)]; }
  /// The largest part; of equal ones the first.
  Doubt largest() const;
};

/// Doubted returns by cause.
struct DoubtCounts {
  std::array<std::size_t, kDoubtCauses> returns{};
  std::array<double, kDoubtCauses> evidence{};  ///< [log-odds] sum over the returns

  void add(const Doubt& doubt);
  void remove(const Doubt& doubt);  ///< one that was added
  DoubtCounts& operator+=(const DoubtCounts& other);
  std::size_t total() const;  ///< returns
};

}  // namespace perception
