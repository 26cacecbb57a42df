#pragma once
#include "gui-offscreen/drawing/Canvas.h"
#include "gui-offscreen/views/SceneView.h"

namespace perception {

/// Legend of the symbols used in pictures of this view. Draws into `at` from the top; returns its
/// lower end [px].
double drawLegend(Canvas& canvas, const SceneView& view, const Rect& at);

}  // namespace perception
