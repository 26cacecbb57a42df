#pragma once
#include "gui-offscreen/Canvas.h"
#include "gui-offscreen/SceneView.h"

namespace perception {

/// Lines and text over the rendered picture: outlines, trails, speed arrows, labels, axes, scale.
/// `at` is the place of the camera's picture on the canvas. Returns how many labels found no room.
int drawOverlay(Canvas& canvas, const SceneView& view, const ViewCamera& camera, const Rect& at);

}  // namespace perception
