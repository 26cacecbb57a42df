#include "gui-offscreen/drawing/ViewPen.h"

namespace perception {

std::optional<Vector2> ViewPen::pixel(const Vector3& p) const {
  const auto px = camera_.project(p);
  if (!px) return std::nullopt;
  return Vector2(px->x() + at_.x, px->y() + at_.y);
}

void ViewPen::line(const Vector3& a, const Vector3& b, const Color& color, double thickness,
                   bool dashed) {
  const Vector2 corner(at_.x, at_.y);
  for (const auto& [from, to] : camera_.projectLine(a, b)) {
    if (dashed) {
      canvas_.dashedLine(from + corner, to + corner, color, thickness, kDash);
    } else {
      canvas_.line(from + corner, to + corner, color, thickness);
    }
  }
}

void ViewPen::box(const std::array<Vector3, 8>& c, const Color& color, double thickness,
                  bool dashed) {
  const bool flat = camera_.kind == ViewKind::kTop;  // roof and floor coincide
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t next = (i + 1) % 4;
    line(c[i], c[next], color, thickness, dashed);
    if (flat) continue;
    line(c[i + 4], c[next + 4], color, thickness, dashed);
    line(c[i], c[i + 4], color, thickness, dashed);
  }
}

}  // namespace perception
