#pragma once
#include <vector>

#include "gui-offscreen/Renderer.h"

namespace perception {

/// How pictures are made.
struct SnapshotParams {
  int width = 1280, height = 720;  ///< [px] of a picture with one view; each more widens it
  double range = 40;               ///< [m] ahead that is shown
  std::vector<ViewKind> views = {ViewKind::kTop};  ///< side by side
};

/// Makes finished pictures: the rendered scene, lines and text over it, a title, a legend. Keep one
/// for the life of the program (see Renderer).
class Snapshot {
 public:
  /// Throws Error(kUnavailable) where the machine has no OpenGL.
  explicit Snapshot(const SnapshotParams& params);

  Picture picture(const SceneView& view);
  /// Several instants on one sheet, in rows, with one legend; each tile has its time and frame.
  Picture contactSheet(const std::vector<SceneView>& views);
  /// The tile of one instant, and the sheet of tiles: for many instants, without keeping them.
  Picture tile(const SceneView& view);
  Picture contactSheet(const std::vector<Picture>& tiles, const SceneView& last);

  /// Labels that found no room on the last picture.
  int labelsLeftOut() const { return labels_left_out_; }

 private:
  void drawView(class Canvas& canvas, const SceneView& view, ViewKind kind, const struct Rect& at);

  SnapshotParams params_;
  int map_width_, map_height_;  ///< [px] of one view
  Renderer renderer_;
  int labels_left_out_ = 0;
};

}  // namespace perception
