#pragma once
#include "gui-offscreen/drawing/Canvas.h"
#include "gui-offscreen/views/SceneView.h"

namespace perception {

/// Marker of a measurement by modality: ring = lidar, triangle = camera, diamond = radar.
void drawMeasurementMark(Canvas& canvas, const Vector2& at, Modality modality);

/// Lines and text over the rendered picture: outlines, trails, speed arrows, labels, axes, scale.
/// On the image of one of the vehicle's cameras (view.image): boxes and labels only. `at`:
/// rectangle of the camera's picture on the canvas. Returns the number of labels not drawn for lack
/// of space.
int drawOverlay(Canvas& canvas, const SceneView& view, const ViewCamera& camera, const Rect& at);

}  // namespace perception
