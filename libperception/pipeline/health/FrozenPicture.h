#pragma once
#include <cstdint>
#include <optional>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Frames of a sensor that repeat the one before to the bit although the vehicle moves: it is not
/// the world that they show (method.md 9.10).
class FrozenPicture {
 public:
  void add(const SensorFrame& frame);
  /// [s] for which the same frame came again, and [m] that the vehicle moved since, if that is too
  /// long for a healthy sensor; else empty.
  struct Frozen {
    double seconds, meters;
  };
  std::optional<Frozen> frozen() const;

 private:
  /// Of what a frame holds; 0: nothing.
  static std::uint64_t fingerprint(const SensorFrame& frame);

  std::uint64_t print_ = 0;
  std::size_t repeated_ = 0;
  Stamp first_, last_;
  Vector2 from_ = Vector2::Zero(), at_ = Vector2::Zero();
};

}  // namespace perception
