#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/grid/SafetyGrid.h"
#include "libperception/grid/beams/WindowFrame.h"
#include "libperception/grid/flat/FlatBeams.h"
#include "libperception/grid/flat/FlatBlock.h"
#include "libperception/grid/stores/CellEvidence.h"

namespace perception {

/// Evidence of one scan for the columns of a 2D window, numbered [y][x]: one beam per bearing, up
/// to its first trusted hit or, without one, its farthest end.
class FlatMarks {
 public:
  explicit FlatMarks(const GridParams& params);

  /// `first`: corner of the window. The marks persist until they are cleared.
  void collect(const GridScan& scan, const CellIndex& first, GridStats& stats);
  /// From a column on: weights of hits in units of 1 / FlatBlock::kWhole, and 1 where a beam
  /// passed.
  std::uint8_t* weights(std::size_t column) { return &weights_[column]; }
  std::uint8_t* crossed(std::size_t column) { return &crossed_[column]; }
  std::size_t memoryBytes() const;

 private:
  void addHits(const GridScan& scan, GridStats& stats);

  GridParams params_;
  int cells_;
  // Hits outside the window mark the element behind the last one.
  std::vector<std::uint8_t> weights_, crossed_;
  FlatBeams beams_;
  FlatBlock hits_;
  WindowFrame frame_;
};

}  // namespace perception
