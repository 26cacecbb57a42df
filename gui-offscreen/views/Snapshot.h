#pragma once
#include <vector>

#include "gui-offscreen/drawing/Canvas.h"
#include "gui-offscreen/drawing/Renderer.h"

namespace perception {

/// Parameters of pictures.
struct SnapshotParams {
  int width = 1280, height = 720;  ///< [px] of a picture with one view; further views widen it
  double range = 40;               ///< [m] ahead that is shown
  std::vector<ViewKind> views = {ViewKind::kTop};  ///< side by side, camera views below
};

/// Makes complete pictures: rendered scene, overlay, title, legend. One instance per process (see
/// Renderer).
class Snapshot {
 public:
  /// Throws Error(kUnavailable) without OpenGL.
  explicit Snapshot(const SnapshotParams& params);

  void setViews(const std::vector<ViewKind>& views);
  Picture picture(const SceneView& view) { return picture(std::vector<SceneView>{view}); }
  /// One or more runs at one instant: side by side, or in rows if there are several views. The size
  /// depends on views and layers only.
  Picture picture(const std::vector<SceneView>& runs);
  /// A smaller picture without title and legend, with time and frame above: for contact sheets.
  Picture tile(const SceneView& view);

  /// The rendered scene without overlay, at the framebuffer's size.
  Picture render(const SceneView& view, const ViewCamera& camera) {
    return renderer_.render(view, camera);
  }

  int viewWidth() const { return map_width_; }    ///< [px] of one view on a picture
  int viewHeight() const { return map_height_; }  ///< [px]
  /// Number of labels omitted on the last picture for lack of space.
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
