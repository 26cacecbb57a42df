#pragma once
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "libperception/grid/SafetyGrid.h"
#include "libperception/grid/way/StopAdvice.h"
#include "libperception/measurement/Measurement.h"
#include "libperception/pipeline/phantoms/PersistentPlaces.h"
#include "libperception/pipeline/safety/RoadHeights.h"
#include "libperception/pipeline/safety/WayReturns.h"
#include "libperception/scene/Scene.h"
#include "libperception/weather/trust/TrustParams.h"

namespace perception {

/// The obstacle returns of a scan; the vectors are as long as the hits, or empty.
struct ObstacleScan {
  GridScan scan;  ///< hits weighted by 1 - their doubt
  /// [0, 1] weight of each hit as part of an obstacle seen in one scan: 0 where doubted, and as far
  /// as something may make phantoms there, without a cluster.
  std::vector<float> dense;
  std::vector<char> doubted;  ///< by trust or shape, whether there is a cause for it or not
  /// May be a surface, though it has a cause to be doubted; empty: nothing may make phantoms.
  std::vector<char> surface;
  RoadHeights road;  ///< by the ground returns
};

/// Obstacle returns by their height, and those that only clear; mirror images below the road are
/// left out (method.md 8.1). The doubt about a return, by its trust and by the shape of its
/// cluster, is at most the probability of a cause that the sensors show (PhantomCauses, labels and
/// echoes by `trust`); none where the directions about it end there as at a wall (method.md 8.4).
/// What hangs higher than `clearance` [m] above the ground is no obstacle.
ObstacleScan obstacleScanOf(const SensorFrame& frame, const PlacedReturns& returns,
                            const TrustParams& trust = {}, const StopParams& stop = {},
                            double clearance = std::numeric_limits<double>::infinity());

/// The way that the vehicle drives, forward or backward, at one instant.
struct PathAhead {
  bool known = false;  ///< false: no lidar scan within half a second
  Corridor corridor;
  FreeDistance free;        ///< `distance` is that of the obstacle, seen up to there or not
  bool in_cloud = false;    ///< most returns up to the obstacle are doubted
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
