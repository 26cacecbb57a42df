#pragma once
#include <cstddef>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/scene/TrackedRun.h"

namespace perception {

/// How the truth is brought to the instants of the scenes.
struct AlignmentOptions {
  double time_limit =
      0.06;  ///< [s] a scene has a truth only when the nearest truth instant is that near
  bool empty_frames = false;  ///< a scene without any line of the truth holds no objects (else
                              ///< nothing is known of it)
};

/// The truth at the instant of one scene.
struct TruthAtScene {
  std::size_t scene = 0;             ///< place in TrackedRun::scenes
  std::vector<TruthObject> objects;  ///< all of them, world frame, at the scene's instant
};

/// All scenes that have a truth, in order of time, and what was left over on both sides.
struct TruthAlignment {
  std::vector<TruthAtScene> instants;
  std::size_t by_frame = 0, by_time = 0;  ///< scenes matched by frame number, by time
  std::size_t assumed_empty = 0;          ///< scenes without a truth line, taken as empty
  std::size_t scenes_without_truth = 0;   ///< nothing known: they do not count
  std::size_t truth_without_scene = 0;    ///< truth instants that no scene met: they do not count
};

/// By frame number when both sides have one, else by time: the truth of one instant (within 1 us)
/// or interpolated between the two around the scene when these are at most twice the limit apart;
/// else the nearest one within the limit, moved by its velocity.
TruthAlignment alignTruth(const TrackedRun& run, const GroundTruth& truth,
                          const AlignmentOptions& options);

}  // namespace perception
