#pragma once
#include <memory>

#include "gui-offscreen/drawing/Picture.h"
#include "gui-offscreen/views/SceneView.h"

namespace perception {

/// Off-screen OpenGL: one framebuffer per process. With two of them MRPT 2.5.8 silently renders
/// wrong pictures, so a second instance is refused. Must be used by the thread that created it.
class Renderer {
 public:
  /// Size of the framebuffer [px]. Throws Error(kUnavailable) without OpenGL.
  Renderer(int width, int height);
  ~Renderer();

  /// Renders the view from the camera at the size of the framebuffer; the camera's picture may be
  /// smaller, with the same aspect ratio.
  Picture render(const SceneView& view, const ViewCamera& camera);

  int width() const { return width_; }
  int height() const { return height_; }

 private:
  struct Impl;
  int width_, height_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace perception
