#include "libperception/pictures/ScenarioDrawing.h"

#include <cmath>

namespace perception {

std::vector<Vector2> footprint(const Vector2& center, double heading, double front, double rear,
                               double width) {
  const Vector2 u(std::cos(heading), std::sin(heading)), n(-u.y(), u.x());
  return {center + front * u + .5 * width * n, center + front * u - .5 * width * n,
          center - rear * u - .5 * width * n, center - rear * u + .5 * width * n};
}

void drawPolygon(Canvas& canvas, const Scale& scale, std::vector<Vector2> corners,
                 const Color& fill) {
  for (Vector2& c : corners) c = scale(c);
  canvas.polygon(corners, fill);
}

void drawOutline(Canvas& canvas, const Scale& scale, const std::vector<Vector2>& corners,
                 const Color& color, double thickness) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    canvas.line(scale(corners[i]), scale(corners[(i + 1) % corners.size()]), color, thickness);
  }
}

}  // namespace perception
