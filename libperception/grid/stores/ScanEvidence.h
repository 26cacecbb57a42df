#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "libperception/grid/SafetyGrid.h"
#include "libperception/grid/beams/WindowMarks.h"
#include "libperception/grid/flat/FlatMarks.h"
#include "libperception/grid/stores/CellEvidence.h"

namespace perception {

/// Evidence of a scan as a list of cells, for back ends that store cells one by one: the same that
/// `rolling` and `rolling2d` add to their arrays. `flat`: one layer for all heights.
class ScanEvidence {
 public:
  ScanEvidence(const GridParams& params, bool flat);

  /// Moves the window to that of a scan.
  void moveTo(const GridScan& scan);
  /// Valid until the next call; the order depends on the scan alone. Moves the window.
  const std::vector<CellEvidence>& collect(const GridScan& scan, GridStats& stats);
  /// Whether the window of the last scan has the cell.
  bool holds(const CellIndex& cell) const;
  std::size_t memoryBytes() const;

  std::int64_t indexOf(double coordinate) const {
    return static_cast<std::int64_t>(std::floor(coordinate / params_.resolution));
  }
  double centerOf(std::int64_t index) const {
    return (static_cast<double>(index) + 0.5) * params_.resolution;
  }

 private:
  void listSpace(bool judged);
  void listFlat(bool judged);
  CellIndex columnAt(std::size_t column) const;

  GridParams params_;
  std::int64_t cells_;       ///< along an edge of the window
  std::int64_t layers_ = 1;  ///< one: flat
  CellIndex first_;          ///< corner of the window
  std::optional<WindowMarks<std::uint64_t>> space_;
  std::optional<FlatMarks> flat_;
  std::vector<CellEvidence> evidence_;
};

}  // namespace perception
