#pragma once
#include <cstdint>
#include <memory>
#include <optional>

#include "libperception/grid/SafetyGrid.h"
#include "libperception/grid/way/StopAdvice.h"
#include "libperception/pipeline/phantoms/PersistentPlaces.h"
#include "libperception/pipeline/safety/ObstacleScan.h"
#include "libperception/pipeline/safety/WayReturns.h"
#include "libperception/scene/Scene.h"

namespace perception {

/// The way that the vehicle drives, forward or backward, at one instant.
struct PathAhead {
  bool known = false;  ///< false: no lidar scan within half a second
  Corridor corridor;
  FreeDistance free;        ///< `distance` is that of the obstacle, seen up to there or not
  bool in_cloud = false;    ///< most returns up to it are doubted, and it is no sure surface
  bool by_returns = false;  ///< of one scan, and not by occupied cells
  std::uint32_t returns = 0, overruled = 0;  ///< as FreePath
};

/// Keeps the safety grid of a run and tells how far the driven path is free (method.md 8.4).
class SafetyMonitor {
 public:
  SafetyMonitor(const GridParams& grid, const StopParams& stop, TrustParams trust = {});

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
  void trustWhatPersists();
  double vehicleHeight() const;  ///< [m] of its highest point

  GridParams params_;
  StopParams stop_;
  TrustParams trust_;
  std::unique_ptr<SafetyGrid> grid_;
  PersistentPlaces places_;  ///< of doubted surfaces, in the newest scan
  ObstacleScan last_;        ///< the newest scan's returns
  WayReturns way_;           ///< those of the last half second on the way
  bool any_ = false;
  std::optional<Stamp> near_;    ///< of the last scene, if an obstacle was too near
  double front_ = 0, rear_ = 0;  ///< [m] own vehicle ahead of the ego origin and behind it
  double highest_ = 0;           ///< [m] lidar above the ground so far
};

}  // namespace perception
