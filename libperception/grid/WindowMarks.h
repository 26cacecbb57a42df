#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/grid/SafetyGrid.h"
#include "libperception/grid/ScanEvidence.h"

namespace perception {

/// What one scan says of the cells of a window, a bit a cell: columns of cells in `Mask`, layer by
/// layer. Every end of a beam gets its ray; rays are followed backwards and end where they run into
/// cells that others have crossed before, since nearer to the sensor they only come closer. So a
/// scan costs by the cells that it sees and not by its beams.
template <class Mask>
class WindowMarks {
 public:
  static constexpr int kMostLayers = static_cast<int>(8 * sizeof(Mask));

  /// A cell with hits of which none is fully trusted.
  struct Doubt {
    std::uint32_t column = 0;
    std::uint8_t layer = 0;
    float weight = 0;  ///< [0, 1) the greatest of its hits
  };

  WindowMarks(const GridParams& params, int layers);

  /// `first`: lowest cell of the window. The marks last until reset().
  void collect(const GridScan& scan, const CellIndex& first, GridStats& stats);
  /// Forgets a column; all of those that were marked must be forgotten before the next scan.
  void reset(std::size_t column) { crossed_[column] = hit_[column] = 0; }

  std::size_t columns() const { return crossed_.size(); }  ///< [y][x]
  Mask crossed(std::size_t column) const { return crossed_[column]; }
  Mask hit(std::size_t column) const { return hit_[column]; }  ///< with full weight
  const std::vector<Doubt>& doubts() const { return doubts_; }
  std::size_t memoryBytes() const;

 private:
  /// A point in cells from the window's corner, and how it lies to the slab.
  struct Place {
    float x, y, z;
    float low, high;  ///< [m] above the slab's lower side, below its upper side
  };

  Place placeOf(const Vector3& p) const;
  bool inWindow(const Place& p) const;
  void takeHits(const GridScan& scan, GridStats& stats);
  void takeClear(const GridScan& scan, GridStats& stats);
  void cast(const Place& end);
  void mergeDoubts();

  GridParams params_;
  int cells_, layers_;
  double per_metre_;
  Vector3 corner_ = Vector3::Zero();                             // [m] world
  double slope_x_ = 0, slope_y_ = 0, slope_z_ = 1, offset_ = 0;  // height above the ground
  Vector2 centre_ = Vector2::Zero();                             // [m] of the vehicle, world
  Place origin_{};
  std::vector<Mask> crossed_, hit_;
  std::vector<Doubt> doubts_;
};

extern template class WindowMarks<std::uint32_t>;
extern template class WindowMarks<std::uint64_t>;

}  // namespace perception
