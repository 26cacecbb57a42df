#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/grid/WindowFrame.h"

namespace perception {

/// The beam of each bearing on the ground: up to its nearest return that stops it or, where there
/// is none, to its farthest.
class FlatBeams {
 public:
  explicit FlatBeams(double step);  ///< [rad] of bearing

  /// Forgets the last scan. `origin`: the sensor.
  void begin(const WindowPlace& origin);
  /// Bearings and ranges of placed points, for offer().
  void look(const PlacedBlock& placed, std::size_t count);
  /// Point k of those, number `index` of the scan.
  void offer(std::size_t k, std::uint32_t index, bool stops) {
    const std::int32_t bearing = bearing_[k];
    if (bearing < 0) return;
    const std::uint64_t key = std::uint64_t{range_[k]} << 32 | index;
    Beam& beam = beams_[static_cast<std::size_t>(bearing)];
    if (stops) {
      beam.nearest = key < beam.nearest ? key : beam.nearest;
    } else {
      beam.farthest = key > beam.farthest ? key : beam.farthest;
    }
  }
  /// Hands the number of the point where it ends to `take`, beam by beam.
  template <class Take>
  void forBeams(const Take& take) const {
    for (const Beam& beam : beams_) {
      if (beam.nearest == kNone && beam.farthest == 0) continue;
      take(static_cast<std::uint32_t>(beam.nearest == kNone ? beam.farthest : beam.nearest));
    }
  }
  std::size_t memoryBytes() const { return beams_.capacity() * sizeof(Beam) + sizeof *this; }

 private:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  /// The range, whose bits grow with it, and the point's number below.
  struct Beam {
    std::uint64_t nearest = kNone, farthest = 0;
  };

  std::vector<Beam> beams_;
  float per_radian_;
  WindowPlace origin_{};
  PlacedBlock::Lane<std::int32_t> bearing_;  // -1: in the sensor's own cell
  PlacedBlock::Lane<std::uint32_t> range_;   // bits of the squared range
};

}  // namespace perception
