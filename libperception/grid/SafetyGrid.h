#pragma once
#include <cstddef>
#include <memory>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/grid/FreeDistance.h"
#include "libperception/grid/GridParams.h"
#include "libperception/grid/GridPoints.h"

namespace perception {

/// One lidar scan as the grid takes it. World frame.
struct GridScan {
  Stamp stamp;
  Vector3 origin = Vector3::Zero();  ///< [m] the sensor
  /// The vehicle on the ground: center of the window, and z = 0 from which heights count.
  Pose3 T_world_ground = Pose3::Identity();
  GridPoints hits;             ///< obstacle returns
  std::vector<float> weights;  ///< [0, 1] of each hit: 1 - P(phantom); empty: all 1
  GridPoints clear;            ///< returns that are no obstacle (ground): their beams only clear
};

/// What insert() made of a scan.
struct GridStats {
  std::size_t hits = 0;        ///< returns that fell into the window
  std::size_t rays = 0;        ///< that cleared space
  std::size_t not_finite = 0;  ///< points that were dropped
  bool late = false;           ///< stamp before the last scan's: taken at the last scan's time
};

/// The lidar's short memory for safety: which cells around the vehicle are occupied, without ever
/// waiting for the filter. Evidence is added once per cell and scan, since returns of one scan are
/// not independent: weight * hit, and (1 - weight) * miss where beams went through. Cells forget
/// with tau; what leaves the window is forgotten at once. Where hits come with weights, one of
/// weight w also voids the share w of "was free": two scans then mark whatever drives in.
class SafetyGrid {
 public:
  virtual ~SafetyGrid() = default;

  virtual GridStats insert(const GridScan& scan) = 0;
  /// At the time of the last scan; 0 = unknown, also outside the window.
  virtual double logOdds(const Vector3& place) const = 0;
  /// All cells above params().occupied, in an order that depends on the scans alone.
  virtual std::vector<GridCell> occupiedCells() const = 0;
  /// All cells that something is known of, in such an order.
  virtual std::vector<GridCell> knownCells() const = 0;
  /// Takes cells of another time or grid into the window of the last scan, as of that scan.
  virtual void restore(const std::vector<GridCell>& cells) = 0;
  virtual std::size_t memoryBytes() const = 0;

  const GridParams& params() const { return params_; }
  bool isOccupied(const Vector3& place) const { return logOdds(place) > params_.occupied; }
  /// How far the vehicle may drive along a corridor.
  FreeDistance freeDistance(const Corridor& corridor) const;

 protected:
  explicit SafetyGrid(const GridParams& params) : params_(params) {}

 private:
  GridParams params_;
};

/// The back end that the parameters name.
std::unique_ptr<SafetyGrid> makeSafetyGrid(const GridParams& params);

}  // namespace perception
