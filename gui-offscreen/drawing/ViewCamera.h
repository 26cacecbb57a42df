#pragma once
#include <optional>
#include <utility>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

enum class ViewKind { kTop, kDriver, kCamera };

/// A virtual camera in the ego frame, used for both the OpenGL rendering and the overlay. The top
/// view is a pinhole at a height of 1 km: 2 m of height shift a point by 0.2 % of its distance from
/// the center. Views of the vehicle's cameras are drawn over their image.
struct ViewCamera {
  ViewKind kind = ViewKind::kTop;
  int width = 0, height = 0;         ///< [px]
  double focal = 1;                  ///< [px]; equirectangular: [px/rad]
  double focal_y = 1;                ///< the same, down the picture
  Vector2 center = Vector2::Zero();  ///< [px] principal point
  CameraModel::Projection projection = CameraModel::Projection::kPinhole;
  Pose3 T_ego_camera = Pose3::Identity();  ///< optical: x right, y down, z forward
  double near = 0.5, far = 500;            ///< [m] clipping planes along the optical axis
  double range = 40;                       ///< [m] displayed ahead

  /// Forward is up; `range` meters ahead of the vehicle at the upper edge, 0.4 range behind it at
  /// the lower one.
  static ViewCamera top(double range, int width, int height);
  /// From above and behind the vehicle, looking ahead.
  static ViewCamera driver(double range, int width, int height);
  /// What a camera of the vehicle sees, `scale` picture pixels per image pixel.
  static ViewCamera image(const CameraModel& model, const Pose3& T_ego_camera, double scale);

  /// Pixel of a point of the ego frame; empty if behind the near plane.
  std::optional<Vector2> project(const Vector3& point) const;
  /// Projection of a line segment: clipped at the near plane; in a panorama piecewise, split at the
  /// seam. Empty if not visible.
  std::vector<std::pair<Vector2, Vector2>> projectLine(const Vector3& a, const Vector3& b) const;
  /// [px/m] at a point of the ego frame in front of the camera.
  double scaleAt(const Vector3& point) const;
};

}  // namespace perception
