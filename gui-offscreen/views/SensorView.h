#pragma once
#include <cstddef>

#include "gui-offscreen/views/SceneView.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Adds what a frame shows to a view: returns of a lidar, at most `most` of them, evenly thinned,
/// with their height above the frame's ground plane; targets of a radar.
void addReturns(const SensorFrame& frame, std::size_t most, SceneView& view);
/// Targets of a radar with their rates over ground: the sensor's own motion, lever arm included, is
/// subtracted.
void addRadar(const SensorFrame& frame, SceneView& view);

}  // namespace perception
