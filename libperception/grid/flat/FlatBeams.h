#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/grid/beams/BeamBlock.h"
#include "libperception/grid/beams/SelectedIndices.h"
#include "libperception/grid/flat/FlatBlock.h"

namespace perception {

/// One beam per bearing in the plane: up to the nearest return that stops it or, without one, to
/// the farthest.
class FlatBeams {
 public:
  /// `step`: [rad] of bearing. `cells`: of the window.
  FlatBeams(double step, int cells);

  /// Starts a scan. `origin`: the sensor.
  void begin(const WindowPlace& origin);
  const BearingBins& bins() const { return bearing_bins_; }
  /// Adds the scan's hits from `first` on.
  void offerHits(const FlatBlock& hits, std::size_t first);
  /// After the hits: adds points that stop no beam. Returns how many are not finite.
  std::size_t offerClear(const GridPoints& points, const WindowFrame& frame);
  /// Marks the columns [y][x] that beams cross. Returns the number of beams.
  std::size_t cross(const GridPoints& hits, const GridPoints& clear, const WindowFrame& frame,
                    std::uint8_t* crossed);
  std::size_t memoryBytes() const {
    return 2 * nearest_.capacity() * (sizeof(float) + sizeof(std::uint32_t)) +
           way_.capacity() * sizeof(std::int32_t) + sizeof *this;
  }

 private:
  static constexpr float kNone = FlatBlock::kNone, kMiddle = 0.5F;
  static constexpr std::size_t kQuadrants = 4;
  static constexpr std::uint32_t kClear = 0x80000000;  // in ends_: the index is of a clear point

  void offerPassing(const std::int32_t* bearings, const float* ranges, std::uint32_t first);
  bool isRedundant(const ClearSurvey& survey) const;
  void findLeast();
  void crossBlock(std::uint8_t* crossed);

  BearingBins bearing_bins_;
  // By bearing, and one for points without: squared ranges [cells^2] of the nearest point that
  // stops the beam and of the farthest that does not, and their indices.
  std::vector<float> nearest_, farthest_;
  std::vector<std::uint32_t> stops_, ends_;
  std::array<float, kQuadrants> least_{};  // minimum of farthest_ in each quadrant of bearings
  int cells_;
  WindowPlace origin_{};
  ClearBlock clear_;
  SelectedIndices relevant_;
  BeamBlock block_;
  std::vector<std::int32_t> way_;  // columns of a beam
};

}  // namespace perception
