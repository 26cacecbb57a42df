#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "gui-offscreen/views/SceneView.h"
#include "gui-offscreen/views/Snapshot.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/pictures/SnapshotSensors.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// A run to be drawn.
struct ShownRun {
  TrackedRun run;
  std::string name;
  std::unique_ptr<SnapshotSensors> sensors;  ///< null without a log
};

/// Parses --view. Throws Error (kUsage).
std::vector<ViewKind> viewsNamed(const std::string& view);

/// Views of several runs at one instant: scene `index` of the first run and the nearest scenes of
/// the others, with sensor data up to then. `truth` may be null. Throws DataError if a run has no
/// scene near.
std::vector<SceneView> viewsOfRuns(const std::vector<ShownRun>& runs, std::size_t index,
                                   const GroundTruth* truth, const std::vector<ViewKind>& views);

}  // namespace perception
