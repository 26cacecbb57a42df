#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "gui-offscreen/SceneView.h"
#include "libperception/grid/SafetyGrid.h"
#include "libperception/lidar/GroundPlane.h"
#include "libperception/scene/TrackedRun.h"
#include "libperception/sensors/FromObservation.h"
#include "libperception/sensors/RawlogReader.h"

namespace perception {

/// What the lidars of a log have seen up to an instant, for pictures of a run: the last returns of
/// each, and the safety grid over the seconds before. The vehicle's places are the run's.
class SnapshotLidar {
 public:
  /// `memory` [s]: scans so long before an instant still count. The run must outlive this.
  SnapshotLidar(const std::string& log, const TrackedRun& run, const GridParams& grid,
                const GroundParams& ground, double memory);

  /// Reads on to `stamp`, which must not go back.
  void advanceTo(Stamp stamp);
  /// Adds returns, cells and the free distance of the lane at the last instant.
  void fill(SceneView& view) const;

  const RawlogReader& reader() const { return reader_; }
  std::uint64_t scans() const { return scans_; }  ///< put into the grid so far

 private:
  struct Lidar {
    GroundEstimator ground;
    Stamp stamp;
    std::vector<ViewPoint> points;  ///< of the last scan
  };

  std::optional<EgoState> egoAt(Stamp stamp) const;
  void take(SensorFrame frame);

  RawlogReader reader_;
  const TrackedRun& run_;
  GroundParams ground_;
  double memory_;
  std::unique_ptr<SafetyGrid> grid_;
  std::map<std::string, Lidar> lidars_;  ///< by label
  std::shared_ptr<mrpt::obs::CObservation> next_;
  std::uint64_t scans_ = 0;
  Stamp now_;
};

}  // namespace perception
