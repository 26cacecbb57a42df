#pragma once
#include <array>
#include <optional>
#include <vector>

#include "gui-offscreen/Canvas.h"
#include "gui-offscreen/SceneView.h"

namespace perception {

/// Draws what is given in the ego frame over a camera's picture; `at`: its place on the canvas.
class ViewPen {
 public:
  static constexpr double kDash = 4;  ///< [px]

  ViewPen(Canvas& canvas, const ViewCamera& camera, const Rect& at)
      : canvas_(canvas), camera_(camera), at_(at) {}

  Canvas& canvas() { return canvas_; }
  const ViewCamera& camera() const { return camera_; }
  const Rect& at() const { return at_; }

  std::optional<Vector2> pixel(const Vector3& p) const;
  void line(const Vector3& a, const Vector3& b, const Color& color, double thickness,
            bool dashed = false);
  /// Edges of a box of the corners as boxCorners() gives them; from above its floor alone.
  void box(const std::array<Vector3, 8>& c, const Color& color, double thickness, bool dashed);

 private:
  Canvas& canvas_;
  const ViewCamera& camera_;
  Rect at_;
};

/// Distances along the axes, the scale, the free lane and the vehicle. Gives the places that text
/// and vehicle take.
std::vector<Rect> drawSurroundings(ViewPen& pen, const SceneView& view);

}  // namespace perception
