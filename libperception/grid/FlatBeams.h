#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/grid/BeamBlock.h"
#include "libperception/grid/WindowFrame.h"

namespace perception {

/// The beam of each bearing on the ground: up to its nearest return that stops it or, where there
/// is none, to its farthest.
class FlatBeams {
 public:
  /// `step`: [rad] of bearing. `cells`: of the window.
  FlatBeams(double step, int cells);

  /// Forgets the last scan. `origin`: the sensor.
  void begin(const WindowPlace& origin);
  /// Placed points that stop no beam, the scan's `first` and following.
  void offerClear(const PlacedBlock& placed, std::size_t count, std::uint32_t first);
  /// Placed points of which some do. `stops`: 0 or 1 for each.
  void offerHits(const PlacedBlock& placed, const std::int32_t* stops, std::size_t count,
                 std::uint32_t first);
  /// Sets the columns [y][x] that beams cross, `place` being where a point of the scan is. Returns
  /// their number.
  template <class Place>
  std::size_t cross(const Place& place, std::uint8_t* crossed) {
    std::size_t beams = 0;
    for (std::size_t bearing = 0; bearing + 1 < beams_.size(); ++bearing) {
      const Beam& beam = beams_[bearing];
      if (!(beam.nearest < kNone) && !(beam.farthest > 0)) continue;
      const WindowPlace end = place(beam.nearest < kNone ? beam.stop : beam.end);
      // On the ground heights play no part.
      block_.add({end.x, end.y, kMiddle, 1, 1});
      ++beams;
      if (block_.count == BeamBlock::kSize) crossBlock(crossed);
    }
    crossBlock(crossed);
    return beams;
  }
  std::size_t memoryBytes() const { return beams_.capacity() * sizeof(Beam) + sizeof *this; }

 private:
  static constexpr float kNone = 3e38F, kMiddle = 0.5F;
  /// Squared ranges [cells^2] of its nearest point that stops it and of its farthest one that does
  /// not, and their numbers.
  struct Beam {
    float nearest = kNone, farthest = 0;
    std::uint32_t stop = 0, end = 0;
  };

  void look(const PlacedBlock& placed, std::size_t count);
  void crossBlock(std::uint8_t* crossed);

  std::vector<Beam> beams_;  // and one for points without a bearing
  float per_radian_;
  int cells_;
  WindowPlace origin_{};
  PlacedBlock::Lane<std::int32_t> bearing_;
  PlacedBlock::Lane<float> range_;
  BeamBlock block_;
};

}  // namespace perception
