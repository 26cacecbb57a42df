#pragma once
#include <vector>

#include "gui-offscreen/drawing/Canvas.h"
#include "libperception/core/Frames.h"

namespace perception {

// Drawing functions for pictures of scenarios and sensor coverage.

inline constexpr double kEgoFront = 4.2, kEgoRear = 1.3, kEgoWidth = 2.0;  ///< [m] of the rear axle

/// Transform from world or ego frame [m] to pixels; y up.
struct Scale {
  Vector2 middle = Vector2::Zero();  ///< [m] position shown at the center of the panel
  Vector2 at = Vector2::Zero();      ///< [px] center of the panel
  double pixels = 1;                 ///< [px/m]
  Vector2 operator()(const Vector2& p) const {
    return {at.x() + pixels * (p.x() - middle.x()), at.y() - pixels * (p.y() - middle.y())};
  }
};

/// Corners [m] of a rectangle that extends `front` ahead of and `rear` behind `center` along
/// `heading` [rad].
std::vector<Vector2> footprint(const Vector2& center, double heading, double front, double rear,
                               double width);

void drawPolygon(Canvas& canvas, const Scale& scale, std::vector<Vector2> corners,
                 const Color& fill);
/// `thickness`: [px].
void drawOutline(Canvas& canvas, const Scale& scale, const std::vector<Vector2>& corners,
                 const Color& color, double thickness);

}  // namespace perception
