#pragma once
#include <cstddef>
#include <memory>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// Association of truth instants with scenes.
struct AlignmentOptions {
  double time_limit =
      0.06;  ///< [s] largest distance in time between a scene and its nearest truth instant
  bool empty_frames =
      false;  ///< true: a scene without truth lines has no objects; false: its truth is unknown
  /// Of a run whose world frame is not that of the truth (its poses are odometry): another run of
  /// the same log, by the poses that the truth was made with. Null: both have one world frame.
  std::shared_ptr<const TrackedRun> truth_poses;
};

/// The truth at the instant of one scene.
struct TruthAtScene {
  std::size_t scene = 0;             ///< index in TrackedRun::scenes
  std::vector<TruthObject> objects;  ///< all objects, world frame, at the scene's stamp
};

/// All scenes with a truth in chronological order, and counts of those without counterpart.
struct TruthAlignment {
  std::vector<TruthAtScene> instants;
  std::size_t by_frame = 0, by_time = 0;  ///< scenes matched by frame number, by time
  std::size_t assumed_empty = 0;          ///< scenes without a truth line, taken as empty
  std::size_t scenes_without_truth = 0;   ///< not evaluated
  std::size_t truth_without_scene = 0;    ///< truth instants without a scene: not evaluated
};

/// By frame number if both have one, else by time: the truth at the same stamp (within 1 us), or
/// interpolated between the two neighboring instants if these are at most twice the limit apart,
/// else the nearest one within the limit, extrapolated by its velocity. With `truth_poses` every
/// object is then where the vehicle of that run sees it, put before the vehicle of this run.
TruthAlignment alignTruth(const TrackedRun& run, const GroundTruth& truth,
                          const AlignmentOptions& options);

}  // namespace perception
