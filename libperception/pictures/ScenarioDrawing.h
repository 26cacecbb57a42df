#pragma once
#include <vector>

#include "gui-offscreen/Canvas.h"
#include "libperception/core/Frames.h"

namespace perception {

// What pictures of scenarios and of vehicles' sensors share.

inline constexpr double kEgoFront = 4.2, kEgoRear = 1.3, kEgoWidth = 2.0;  ///< [m] of the rear axle

/// World or vehicle meters to pixels; y points up.
struct Scale {
  Vector2 middle = Vector2::Zero();  ///< [m] at the panel's middle
  Vector2 at = Vector2::Zero();      ///< [px] the panel's middle
  double pixels = 1;                 ///< [px/m]
  Vector2 operator()(const Vector2& p) const {
    return {at.x() + pixels * (p.x() - middle.x()), at.y() - pixels * (p.y() - middle.y())};
  }
};

/// Corners [m] of what reaches `front` and `rear` from `center` along `heading` [rad].
std::vector<Vector2> footprint(const Vector2& center, double heading, double front, double rear,
                               double width);

void drawPolygon(Canvas& canvas, const Scale& scale, std::vector<Vector2> corners,
                 const Color& fill);
/// `thickness`: [px].
void drawOutline(Canvas& canvas, const Scale& scale, const std::vector<Vector2>& corners,
                 const Color& color, double thickness);

}  // namespace perception
