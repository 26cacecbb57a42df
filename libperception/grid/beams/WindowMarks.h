#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/grid/SafetyGrid.h"
#include "libperception/grid/beams/BeamBlock.h"
#include "libperception/grid/beams/BeamCover.h"
#include "libperception/grid/beams/BeamFans.h"
#include "libperception/grid/beams/WindowFrame.h"
#include "libperception/grid/stores/CellEvidence.h"

namespace perception {

/// Evidence of one scan for the cells of a window, a bit per cell: a `Mask` per column with a bit
/// per layer. Beams are followed only where no other of their direction was (BeamCover).
template <class Mask>
class WindowMarks {
 public:
  static constexpr int kMostLayers = static_cast<int>(8 * sizeof(Mask));

  /// A cell whose hits all have a weight below 1.
  struct SoftHit {
    std::uint32_t column = 0;
    std::uint8_t layer = 0;
    bool crossed = false;  ///< a beam passed through
    float weight = 0;      ///< [0, 1) largest of its hits
  };

  WindowMarks(const GridParams& params, int layers);

  /// `first`: lowest cell of the window. The marks persist until reset().
  void collect(const GridScan& scan, const CellIndex& first, GridStats& stats);
  /// Clears a column; all marked columns must be cleared before the next scan.
  void reset(std::size_t column) { crossed_[fans_.margin() + column] = hit_[column] = 0; }

  /// Crossed layers, without cells in doubts(). Columns are numbered [y][x].
  Mask crossed(std::size_t column) const { return crossed_[fans_.margin() + column]; }
  Mask hit(std::size_t column) const { return hit_[column]; }  ///< with full weight
  /// Mutable access to a column and the following ones, for reading and clearing at once.
  Mask* crossings(std::size_t column) { return &crossed_[fans_.margin() + column]; }
  Mask* hits(std::size_t column) { return hit_.data() + column; }
  const std::vector<SoftHit>& doubts() const { return soft_hits_; }  ///< by column and layer
  std::size_t memoryBytes() const;

 private:
  std::size_t columns() const {
    return static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_);
  }
  void addHits(const GridScan& scan, GridStats& stats);
  bool addHit(std::int32_t cell, float weight);
  void addClear(const GridScan& scan, GridStats& stats);
  void addBeam(std::size_t k) {
    if (rays_) beams_.add(placed_.at(k));
  }
  void finishBlock(GridStats& stats);
  void castBeams();
  void settleSoftHits();

  GridParams params_;
  int cells_, layers_;
  WindowFrame frame_;
  bool rays_ = false;
  WindowPlace origin_{};
  BeamCover cover_;
  PlacedBlock placed_;
  BeamBlock beams_;
  BeamFans<Mask> fans_;
  std::vector<Mask> crossed_;  // including the margins of fans_
  std::vector<Mask> hit_;
  std::vector<SoftHit> soft_hits_;
};

extern template class WindowMarks<std::uint32_t>;
extern template class WindowMarks<std::uint64_t>;

}  // namespace perception
