#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/grid/BeamBlock.h"
#include "libperception/grid/BeamCover.h"
#include "libperception/grid/BeamFans.h"
#include "libperception/grid/SafetyGrid.h"
#include "libperception/grid/ScanEvidence.h"
#include "libperception/grid/WindowFrame.h"

namespace perception {

/// What one scan says of the cells of a window, a bit a cell: columns of cells in `Mask`, layer by
/// layer. Every beam is followed as far as no other of its direction was before (BeamCover).
template <class Mask>
class WindowMarks {
 public:
  static constexpr int kMostLayers = static_cast<int>(8 * sizeof(Mask));

  /// A cell with hits of which none is fully trusted.
  struct SoftHit {
    std::uint32_t column = 0;
    std::uint8_t layer = 0;
    bool crossed = false;  ///< a beam went through
    float weight = 0;      ///< [0, 1) the greatest of its hits
  };

  WindowMarks(const GridParams& params, int layers);

  /// `first`: lowest cell of the window. The marks last until reset().
  void collect(const GridScan& scan, const CellIndex& first, GridStats& stats);
  /// Forgets a column; all of those that were marked must be forgotten before the next scan.
  void reset(std::size_t column) { crossed_[fans_.margin() + column] = hit_[column] = 0; }

  /// Without the cells in doubt. Columns are numbered [y][x].
  Mask crossed(std::size_t column) const { return crossed_[fans_.margin() + column]; }
  Mask hit(std::size_t column) const { return hit_[column]; }  ///< with full weight
  /// To be read and forgotten in one go: those of a column and the ones behind it.
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
  std::vector<Mask> crossed_;  // with the margins of fans_
  std::vector<Mask> hit_;
  std::vector<SoftHit> soft_hits_;
};

extern template class WindowMarks<std::uint32_t>;
extern template class WindowMarks<std::uint64_t>;

}  // namespace perception
