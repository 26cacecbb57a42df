#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "libperception/grid/SafetyGrid.h"
#include "libperception/grid/StopAdvice.h"
#include "libperception/measurement/Measurement.h"
#include "libperception/scene/Scene.h"

namespace perception {

/// The obstacle returns of a scan.
struct ObstacleScan {
  GridScan scan;  ///< hits weighted by trust and by P(no phantom) of their clusters
  /// [0, 1] weight of each hit as part of an obstacle seen in one scan: 0 without a cluster or
  /// where doubted.
  std::vector<float> clustered;
};

/// Obstacle returns by their height, and those that only clear; mirror images below the road are
/// left out (method.md 8.1).
ObstacleScan obstacleScanOf(const SensorFrame& frame, const PlacedReturns& returns);

/// The way ahead at one instant.
struct PathAhead {
  bool known = false;  ///< false: no lidar scan within half a second
  Corridor corridor;
  FreeDistance free;
  bool in_cloud = false;  ///< most returns up to the obstacle are doubted
};

/// Keeps the safety grid of a run and tells how far the driven path is free (method.md 8.4).
class SafetyMonitor {
 public:
  SafetyMonitor(const GridParams& grid, const StopParams& stop);

  /// A lidar scan, in order of time; `frame` with trust.
  void add(const SensorFrame& frame, const PlacedReturns& returns);
  /// The path ahead as of the last scan.
  PathAhead pathAhead(const EgoState& ego) const;
  /// For a known path: free distance, advice and cause for a scene with its objects. Scenes in
  /// order of time: for an obstacle in a cloud a stop takes two in a row.
  FreePath advise(const PathAhead& path, const Scene& scene);
  /// Forgets the grid, as when the world frame changes.
  void restart();

  const SafetyGrid& grid() const { return *grid_; }

 private:
  GridParams params_;
  StopParams stop_;
  std::unique_ptr<SafetyGrid> grid_;
  ObstacleScan last_;  ///< the newest scan's returns
  bool any_ = false;
  std::optional<Stamp> near_;  ///< of the last scene, if an obstacle was too near
  double front_ = 0;           ///< [m] x of the own vehicle's front, ego frame
};

}  // namespace perception
