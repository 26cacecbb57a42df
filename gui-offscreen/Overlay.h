#pragma once
#include "gui-offscreen/Canvas.h"
#include "gui-offscreen/SceneView.h"

namespace perception {

/// What a front end took, as a sign of its sensor: ring = lidar, triangle = camera, diamond =
/// radar.
void drawMeasurementMark(Canvas& canvas, const Vector2& at, Modality modality);

/// Lines and text over the rendered picture: outlines, trails, speed arrows, labels, axes, scale.
/// On the image of one of the vehicle's cameras (view.image): boxes and labels alone.
/// `at` is the place of the camera's picture on the canvas. Returns how many labels found no room.
int drawOverlay(Canvas& canvas, const SceneView& view, const ViewCamera& camera, const Rect& at);

}  // namespace perception
