#pragma once
#include <cstdint>
#include <vector>

#include "libperception/grid/SafetyGrid.h"
#include "libperception/grid/ScanEvidence.h"

namespace perception {

/// What grids on MRPT's maps of one byte a cell share: evidence, decay and the window that moves
/// with the vehicle. A back end owns the bytes, in rows along x, and says where its cells stand.
class ByteCellGrid : public SafetyGrid {
 public:
  GridStats insert(const GridScan& scan) final;
  double logOdds(const Vector3& place) const final;
  std::vector<GridCell> occupiedCells() const final;
  std::vector<GridCell> knownCells() const final;
  void restore(const std::vector<GridCell>& cells) final;
  std::size_t memoryBytes() const override;

 protected:
  using Cell = std::int8_t;  ///< log-odds in sixteenths (LOGODD_K), free is > 0; 0: unknown

  ByteCellGrid(const GridParams& params, bool flat);

  /// The cells of a row, from the window's corner on.
  virtual const Cell* row(std::int64_t y, std::int64_t z) const = 0;
  /// Lowest cell of the window about a vehicle.
  virtual CellIndex cornerOf(const Pose3& T_world_ground) const = 0;
  /// A cell of the world as others see it.
  virtual GridCell describe(const CellIndex& cell, double log_odds) const = 0;

  const ScanEvidence& evidence() const { return evidence_; }
  std::int64_t cells() const { return cells_; }    ///< along an edge
  std::int64_t layers() const { return layers_; }  ///< 1 where all heights share a cell
  const Pose3& vehicle() const { return T_world_ground_; }

 private:
  Cell* changeableRow(std::int64_t y, std::int64_t z) { return const_cast<Cell*>(row(y, z)); }
  const Cell* find(const CellIndex& cell) const;
  CellIndex indexOf(const Vector3& place) const;
  void advance(const GridScan& scan, GridStats& stats);
  void moveTo(const CellIndex& corner);
  void decay();
  void add(const CellIndex& cell, double log_odds);
  double pendingDecay() const;
  double valueOf(Cell cell) const;
  template <class Wanted>
  std::vector<GridCell> cellsWhere(const Wanted& wanted) const;

  ScanEvidence evidence_;
  bool flat_;
  std::int64_t cells_, layers_ = 1;
  CellIndex corner_;  // of the window, in cells of the world
  Pose3 T_world_ground_ = Pose3::Identity();
  bool started_ = false;
  Stamp now_, decayed_;  // of the last scan; up to which the cells have decayed
};

}  // namespace perception
