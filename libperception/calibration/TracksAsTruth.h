#pragma once
#include "libperception/core/GroundTruth.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// What a run tracked, as labels of its log (method.md 8.15): objects that were there for a second,
/// surely, and of one class; others have the type "unknown". An object counts after the first scene
/// that shows it and before its last measurement: the two ends of a track are no chance to detect
/// the object. `occluded`: as in TruthObject, for all objects.
GroundTruth tracksAsTruth(const TrackedRun& run, int occluded);

/// Labels of a log, and of the run's tracks those that no label is near: things (static-other) as
/// such, road users as "unknown", for labels leave out much. Instants of the run that are labeled.
GroundTruth withTracks(const GroundTruth& labeled, const TrackedRun& run, int occluded);

}  // namespace perception
