#pragma once
#include <optional>
#include <utility>

#include "libperception/core/Frames.h"

namespace perception {

enum class ViewKind { kTop, kDriver };

/// A pinhole camera about the vehicle, in the ego frame: the same one draws the solid things in
/// OpenGL and places text and lines on the picture. The top view is a pinhole, too, one kilometre
/// up: 2 m of height shift a place by 0.2 % of its distance from the middle.
struct ViewCamera {
  ViewKind kind = ViewKind::kTop;
  int width = 0, height = 0;               ///< [px]
  double focal = 1;                        ///< [px]
  Pose3 T_ego_camera = Pose3::Identity();  ///< optical: x right, y down, z forward
  double near = 0.5, far = 500;            ///< [m] of what is drawn, along the optical axis
  double range = 40;                       ///< [m] ahead that the view shows

  /// Forward is up; `range` metres ahead of the vehicle at the upper edge, 0.4 range behind it at
  /// the lower one.
  static ViewCamera top(double range, int width, int height);
  /// From above and behind the vehicle, looking ahead.
  static ViewCamera driver(double range, int width, int height);

  /// Pixel of a point of the ego frame; empty when it lies behind the near plane.
  std::optional<Vector2> project(const Vector3& point) const;
  /// A line between two points, cut at the near plane.
  std::optional<std::pair<Vector2, Vector2>> project(const Vector3& a, const Vector3& b) const;
  /// [px/m] at a point of the ego frame in front of the camera.
  double scaleAt(const Vector3& point) const;
};

}  // namespace perception
