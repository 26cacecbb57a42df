#pragma once
#include <cstdint>
#include <vector>

#include "gui-offscreen/SceneView.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/scene/TrackedRun.h"

namespace perception {

/// [s] A scene farther from the asked time is not of it: half the period of a scene a second.
inline constexpr double kNearestScene = 0.51;

/// The scene nearest to the stamp; the run has one at least.
std::size_t nearestScene(const TrackedRun& run, Stamp stamp);
/// The scene at a time since the log's first stamp [s]. Throws Error (kUsage): none near.
std::size_t sceneAt(const TrackedRun& run, double t);
/// The scene of a frame number. Throws Error (kUsage): there is none.
std::size_t sceneOfFrame(const TrackedRun& run, std::int64_t number);
/// The scenes between two times since the log's first stamp [s]. Throws Error (kUsage): none.
std::vector<std::size_t> scenesBetween(const TrackedRun& run, double from, double to);
/// A scene every so many seconds [s], the first among them; 0: all. The run has one at least.
std::vector<std::size_t> scenesEvery(const TrackedRun& run, double every);
/// `count` of `all`, evenly spread, the first and the last among them.
std::vector<std::size_t> spread(const std::vector<std::size_t>& all, std::size_t count);

/// What a picture of the scene shows of the run alone: objects, trails and, by frame number where
/// both have one, else by time, the truth. `truth` may be null.
SceneView viewOfScene(const TrackedRun& run, std::size_t index, const GroundTruth* truth);

}  // namespace perception
