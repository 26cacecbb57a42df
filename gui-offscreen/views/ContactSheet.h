#pragma once
#include <vector>

#include "gui-offscreen/drawing/Picture.h"
#include "gui-offscreen/views/SceneView.h"

namespace perception {

/// Tiles of Snapshot::tile() on one sheet, in rows from the upper left, about as many rows as
/// columns of views, with the title and legend of `view`. Tiles must have equal size.
Picture contactSheet(const std::vector<Picture>& tiles, const SceneView& view);

}  // namespace perception
