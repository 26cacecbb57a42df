#pragma once
#include <string>

#include "gui-offscreen/views/SceneView.h"

namespace perception {

/// Writes the view as a .3Dscene for MRPT's SceneViewer3D: the rendered objects of the pictures,
/// and labels, velocities, trails and measurements as named 3D objects. Ego frame [m]. `range` [m]:
/// extent of the ground grid. `mark`: runMark(), the name of an empty object. Throws OutputError.
void writeSceneFile(const std::string& path, const SceneView& view, double range,
                    const std::string& mark = "");

}  // namespace perception
