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
  /// Where directions begin and how many there are.
  struct Rose {
    float x, y;  ///< [cells]
    float per_radian;
    std::int32_t count;
  };

  /// `step`: [rad] of bearing. `cells`: of the window.
  FlatBeams(double step, int cells);

  /// Forgets the last scan. `origin`: the sensor.
  void begin(const WindowPlace& origin);
  /// Points that stop no beam, the scan's `first` and following. Returns how many are no numbers.
  std::size_t offerClear(const GridPoints& points, const WindowFrame& frame, std::uint32_t first);
  /// Placed points of which some stop a beam. `stops`: 0 or 1 for each.
  void offerHits(const PlacedBlock& placed, const std::int32_t* stops, std::size_t count,
                 std::uint32_t first);
  /// Sets the columns [y][x] that beams cross, `place` being where a point of the scan is. Returns
  /// their number.
  template <class Place>
  std::size_t cross(const Place& place, std::uint8_t* crossed) {
    std::size_t beams = 0;
    for (std::size_t bearing = 0; bearing < bearings_; ++bearing) {
      const bool stopped = nearest_[bearing] < kNone;
      if (!stopped && !(farthest_[bearing] > 0)) continue;
      const WindowPlace end = place(stopped ? stops_[bearing] : ends_[bearing]);
      // On the ground heights play no part.
      block_.add({end.x, end.y, kMiddle, 1, 1});
      ++beams;
      if (block_.count == BeamBlock::kSize) crossBlock(crossed);
    }
    crossBlock(crossed);
    return beams;
  }
  std::size_t memoryBytes() const {
    return 2 * nearest_.capacity() * (sizeof(float) + sizeof(std::uint32_t)) + sizeof *this;
  }

 private:
  static constexpr float kNone = 3e38F, kMiddle = 0.5F;

  Rose rose() const;
  void crossBlock(std::uint8_t* crossed);

  std::size_t bearings_;
  // By bearing, and one for points without: squared ranges [cells^2] of the nearest point that
  // stops the beam and of the farthest that does not, and their numbers.
  std::vector<float> nearest_, farthest_;
  std::vector<std::uint32_t> stops_, ends_;
  float per_radian_;
  int cells_;
  WindowPlace origin_{};
  PlacedBlock::Lane<std::int32_t> bearing_;
  PlacedBlock::Lane<float> range_;
  BeamBlock block_;
};

}  // namespace perception
