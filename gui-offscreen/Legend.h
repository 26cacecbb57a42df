#pragma once
#include "gui-offscreen/Canvas.h"
#include "gui-offscreen/SceneView.h"

namespace perception {

/// Explains every symbol that pictures of this view may hold. Draws into `at`, from the top;
/// returns where it ends [px].
double drawLegend(Canvas& canvas, const SceneView& view, const Rect& at);

}  // namespace perception
