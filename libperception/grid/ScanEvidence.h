#pragma once
#include <cmath>
#include <cstdint>
#include <vector>

#include "libperception/grid/SafetyGrid.h"

namespace perception {

/// Integer coordinates of a cell in the world frame.
struct CellIndex {
  std::int64_t x = 0, y = 0, z = 0;
};

/// [log-odds] by which a hit of known weight resets a free cell (negative log-odds): a return
/// trusted as surface means that an object has entered. Hits of unknown trust may be of
/// precipitation and only accumulate.
inline double voidedBy(double weight, double log_odds) {
  return log_odds < 0 ? -weight * log_odds : 0;
}

/// Evidence of one scan about one cell.
struct CellEvidence {
  CellIndex cell;
  double weight = 0;     ///< [0, 1] largest of the cell's hits
  bool crossed = false;  ///< a clearing ray went through
  bool relevant = true;  ///< within the slab itself, before its widening
  bool judged = false;   ///< the hits of the scan have weights

  /// [log-odds] w hit + (1 - w) miss, the miss only where a beam passed, plus voidedBy() of
  /// `before` for hits with weights.
  double logOdds(const GridParams& params, double before) const {
    return weight * params.hit + (crossed ? (1 - weight) * params.miss : 0) +
           (judged ? voidedBy(weight, before) : 0);
  }
};

/// Reduces a scan to at most one piece of evidence per cell of the window, in flat arrays, which
/// are faster than a hash set of cells. Rays are subsampled, hits are not. `flat`: one layer for
/// all heights.
class ScanEvidence {
 public:
  ScanEvidence(const GridParams& params, bool flat);

  /// Valid until the next call; the order depends on the scan alone.
  const std::vector<CellEvidence>& collect(const GridScan& scan, GridStats& stats);
  std::size_t memoryBytes() const;

  std::int64_t indexOf(double coordinate) const {
    return static_cast<std::int64_t>(std::floor(coordinate / params_.resolution));
  }
  double centerOf(std::int64_t index) const {
    return (static_cast<double>(index) + 0.5) * params_.resolution;
  }

 private:
  /// The return selected for one direction.
  struct Ray {
    float range = 0;          ///< [m] 0: none
    std::uint32_t point = 0;  ///< index into the scan's hits followed by its clear points
    bool stopped = false;     ///< by a trusted hit
  };

  void placeWindow(const GridScan& scan);
  void markHits(const GridScan& scan, GridStats& stats);
  void chooseRays(const GridScan& scan, GridStats& stats);
  void offerRay(const GridScan& scan, std::size_t point, bool stops);
  void castRay(const Vector3& origin, const Vector3& end);
  bool isRelevant(const CellIndex& cell) const;
  bool inSlab(const Vector3& place) const;
  void touch(std::size_t cell, std::uint8_t mark);
  CellIndex cellAt(std::size_t cell) const;

  GridParams params_;
  bool flat_;
  std::int64_t cells_;  ///< along an edge of the window
  std::int64_t layers_ = 1;
  CellIndex first_;  ///< corner of the window
  Pose3 T_ground_world_ = Pose3::Identity();
  std::vector<std::uint8_t> marks_;     ///< bit 7: crossed; the rest: weight * 127
  std::vector<std::uint32_t> touched_;  ///< indices into marks_
  std::size_t bearings_, elevations_;   ///< directions of clearing rays
  std::vector<Ray> rays_;               ///< [bearing][elevation]
  std::vector<CellEvidence> evidence_;
};

}  // namespace perception
