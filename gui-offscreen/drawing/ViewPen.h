#pragma once
#include <array>
#include <optional>
#include <vector>

#include "gui-offscreen/drawing/Canvas.h"
#include "gui-offscreen/views/SceneView.h"

namespace perception {

/// Draws primitives given in the ego frame over a camera's picture; `at`: its rectangle on the
/// canvas.
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
  /// Edges of a box with corners by boxCorners(); in the top view its base only.
  void box(const std::array<Vector3, 8>& c, const Color& color, double thickness, bool dashed);

 private:
  Canvas& canvas_;
  const ViewCamera& camera_;
  Rect at_;
};

/// Draws axis distances, scale, free corridor and vehicle. Returns the rectangles of text and
/// vehicle.
std::vector<Rect> drawSurroundings(ViewPen& pen, const SceneView& view);

}  // namespace perception
