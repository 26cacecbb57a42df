#pragma once
#include <vector>

#include "gui-offscreen/Canvas.h"
#include "gui-offscreen/Renderer.h"

namespace perception {

/// How pictures are made.
struct SnapshotParams {
  int width = 1280, height = 720;  ///< [px] of a picture with one view; each more widens it
  double range = 40;               ///< [m] ahead that is shown
  std::vector<ViewKind> views = {ViewKind::kTop};  ///< side by side; a camera's below the others
};

/// Makes finished pictures: the rendered scene, lines and text over it, a title, a legend. Keep one
/// for the life of the program (see Renderer).
class Snapshot {
 public:
  /// Throws Error(kUnavailable) where the machine has no OpenGL.
  explicit Snapshot(const SnapshotParams& params);

  void setViews(const std::vector<ViewKind>& views);
  Picture picture(const SceneView& view) { return picture(std::vector<SceneView>{view}); }
  /// Several runs at one instant, at least one: side by side, or below each other where each has
  /// more than one view. Same views, same layers: same size.
  Picture picture(const std::vector<SceneView>& runs);
  /// The same without title and legend, smaller, with time and frame above: for a contact sheet.
  Picture tile(const SceneView& view);

  /// The solid things alone, at the framebuffer's size.
  Picture render(const SceneView& view, const ViewCamera& camera) {
    return renderer_.render(view, camera);
  }

  int viewWidth() const { return map_width_; }    ///< [px] of one view on a picture
  int viewHeight() const { return map_height_; }  ///< [px]
  /// Labels that found no room on the last picture.
  int labelsLeftOut() const { return labels_left_out_; }

 private:
  struct Panel {
    std::size_t run;
    ViewKind kind;
    Rect at;
  };
  struct Layout {
    double width = 0, height = 0;  ///< [px]
    std::vector<Panel> panels;
    double legend_x = 0;
  };
  Layout layOut(const std::vector<SceneView>& runs) const;
  void drawView(Canvas& canvas, const SceneView& view, ViewKind kind, const Rect& at);
  void drawImage(Canvas& canvas, const SceneView& view, const Rect& at);

  SnapshotParams params_;
  std::vector<ViewKind> maps_;  ///< the views without the camera's
  bool with_camera_ = false;
  int map_width_, map_height_;  ///< [px] of one view
  Renderer renderer_;
  int labels_left_out_ = 0;
};

}  // namespace perception
