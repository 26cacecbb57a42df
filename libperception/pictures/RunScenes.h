#pragma once
#include <cstdint>
#include <vector>

#include "gui-offscreen/views/SceneView.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// [s] Largest distance in time of a scene from the requested time: half the period of 1 Hz.
inline constexpr double kNearestScene = 0.51;

/// Index of the scene nearest to the stamp; the run must have a scene.
std::size_t nearestScene(const TrackedRun& run, Stamp stamp);
/// Index of the scene at t [s] since the log's first stamp. Throws Error (kUsage) if none is near.
std::size_t sceneAt(const TrackedRun& run, double t);
/// Index of the scene of a frame number. Throws Error (kUsage) if there is none.
std::size_t sceneOfFrame(const TrackedRun& run, std::int64_t number);
/// Scenes between two times [s] since the log's first stamp. Throws Error (kUsage) if there are
/// none.
std::vector<std::size_t> scenesBetween(const TrackedRun& run, double from, double to);
/// One scene every `every` seconds, beginning with the first; 0: all. The run must have a scene.
std::vector<std::size_t> scenesEvery(const TrackedRun& run, double every);
/// `count` of `all`, evenly spaced, including the first and the last.
std::vector<std::size_t> spread(const std::vector<std::size_t>& all, std::size_t count);

/// Adds the truth of the view's scene: by frame number if both have one, else by time.
void addTruth(const GroundTruth& truth, SceneView& view);
/// View of a scene without sensor data: objects, trails and, by frame number if both have one, else
/// by time, the truth. `truth` may be null.
SceneView viewOfScene(const TrackedRun& run, std::size_t index, const GroundTruth* truth);

}  // namespace perception
