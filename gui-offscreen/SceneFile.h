#pragma once
#include <string>

#include "gui-offscreen/SceneView.h"

namespace perception {

/// Writes the view as a .3Dscene of MRPT, to be turned and zoomed in its SceneViewer3D: the solid
/// things of the pictures, and labels, velocities, paths and measurements as 3D objects, each with
/// a name. Ego frame [m]. `range` [m]: extent of the ground's lines. Throws OutputError.
void writeSceneFile(const std::string& path, const SceneView& view, double range);

}  // namespace perception
