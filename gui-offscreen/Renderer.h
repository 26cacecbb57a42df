#pragma once
#include <memory>

#include "gui-offscreen/Picture.h"
#include "gui-offscreen/SceneView.h"

namespace perception {

/// OpenGL without a display: one framebuffer for the life of the program. MRPT 2.5.8 draws silently
/// wrong pictures when two of them are used in turn, so a second one is refused; and it must be
/// used by the thread that made it.
class Renderer {
 public:
  /// Size of the framebuffer [px]. Throws Error(kUnavailable) where the machine has no OpenGL.
  Renderer(int width, int height);
  ~Renderer();

  /// The view, from the camera, at the framebuffer's size; the camera's own picture may be smaller
  /// but has the same shape.
  Picture render(const SceneView& view, const ViewCamera& camera);

  int width() const { return width_; }
  int height() const { return height_; }

 private:
  struct Impl;
  int width_, height_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace perception
