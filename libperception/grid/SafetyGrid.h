#pragma once
#include <cstddef>
#include <memory>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/grid/GridParams.h"
#include "libperception/grid/beams/GridPoints.h"
#include "libperception/grid/way/FreeDistance.h"

namespace perception {

/// One lidar scan for the grid. World frame.
struct GridScan {
  Stamp stamp;
  Vector3 origin = Vector3::Zero();  ///< [m] position of the sensor
  /// Ego frame, leveled: its origin is the center of the window and the zero of heights.
  Pose3 T_world_ground = Pose3::Identity();
  GridPoints hits;             ///< obstacle returns
  std::vector<float> weights;  ///< [0, 1] of each hit: 1 - P(phantom); empty: all 1
  GridPoints clear;            ///< returns of the ground: their beams only clear
};

/// Statistics of an inserted scan.
struct GridStats {
  std::size_t hits = 0;        ///< returns within the window
  std::size_t rays = 0;        ///< beams that cleared space
  std::size_t not_finite = 0;  ///< points that were dropped
  bool late = false;           ///< older than the last scan; inserted at its time
};

/// Occupancy grid around the vehicle, independent of the filter (method.md 8.4). Evidence is added
/// once per cell and scan, since returns of one scan are not independent: weight * hit, and (1 -
/// weight) * miss where beams passed. Cells decay with tau and are dropped outside the window. With
/// weights, a hit of weight w also removes the share w of a negative log-odds: two scans then mark
/// a cell that an object enters.
class SafetyGrid {
 public:
  virtual ~SafetyGrid() = default;

  virtual GridStats insert(const GridScan& scan) = 0;
  /// At the time of the last scan; 0 = unknown, also outside the window.
  virtual double logOdds(const Vector3& place) const = 0;
  /// The occupied cells whose centers lie in the area, in an order that depends on the scans alone.
  virtual std::vector<GridCell> occupiedWithin(const GridArea& area) const = 0;
  std::vector<GridCell> occupiedCells() const { return occupiedWithin({}); }
  /// All cells with evidence, ordered likewise.
  virtual std::vector<GridCell> knownCells() const = 0;
  /// Inserts stored cells of another grid into the window of the last scan, at its time.
  virtual void restore(const std::vector<GridCell>& cells) = 0;
  virtual std::size_t memoryBytes() const = 0;

  const GridParams& params() const { return params_; }
  bool isOccupied(const Vector3& place) const { return logOdds(place) > params_.occupied; }
  /// Distance along a corridor to its first occupied cells, and how far it was observed.
  FreeDistance freeDistance(const Corridor& corridor) const;

 protected:
  static std::vector<GridCell> within(const GridArea& area, std::vector<GridCell> cells);
  explicit SafetyGrid(const GridParams& params) : params_(params) {}

 private:
  GridParams params_;
};

/// The back end selected by the parameters.
std::unique_ptr<SafetyGrid> makeSafetyGrid(const GridParams& params);

}  // namespace perception
