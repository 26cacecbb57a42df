#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "gui-offscreen/SceneView.h"
#include "gui-offscreen/Snapshot.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/pictures/SnapshotSensors.h"
#include "libperception/scene/TrackedRun.h"

namespace perception {

/// A run that is drawn.
struct ShownRun {
  TrackedRun run;
  std::string name;
  std::unique_ptr<SnapshotSensors> sensors;  ///< where there is a log
};

/// The views that --view asks for. Throws Error (kUsage).
std::vector<ViewKind> viewsNamed(const std::string& view);

/// What is drawn of the runs: of the first one its scene `index`, of the others those nearest to
/// its time, with what their sensors have seen until then. `truth` may be null. Throws DataError:
/// no scene near.
std::vector<SceneView> viewsOfRuns(const std::vector<ShownRun>& runs, std::size_t index,
                                   const GroundTruth* truth, const std::vector<ViewKind>& views);

}  // namespace perception
