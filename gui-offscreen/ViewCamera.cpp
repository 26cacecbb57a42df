#include "gui-offscreen/ViewCamera.h"

#include <algorithm>

namespace perception {
namespace {

constexpr double kTopHeight = 1000;  // [m] of the top view's pinhole
constexpr double kTopDepth = 60;     // [m] above and below the ground that it shows
constexpr double kBehind = 0.4;      // of the range that the top view shows behind the vehicle
constexpr double kDriverBack = 12, kDriverUp = 8;   // [m] from the ego origin
constexpr double kDriverPitch = radians(20);        // down
constexpr double kDriverFieldOfView = radians(72);  // horizontal

Vector2 pixelOf(const ViewCamera& camera, const Vector3& optical) {
  return {camera.width / 2.0 + camera.focal * optical.x() / optical.z(),
          camera.height / 2.0 + camera.focal * optical.y() / optical.z()};
}

}  // namespace

ViewCamera ViewCamera::top(double range, int width, int height) {
  ViewCamera camera{ViewKind::kTop, width, height};
  camera.range = range;
  camera.focal = height / ((1 + kBehind) * range) * kTopHeight;
  camera.T_ego_camera.translation() = Vector3((1 - kBehind) / 2 * range, 0, kTopHeight);
  // Right of the picture is -y, down is -x, into the picture is -z.
  camera.T_ego_camera.linear() << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  camera.near = kTopHeight - kTopDepth;
  camera.far = kTopHeight + kTopDepth;
  return camera;
}

ViewCamera ViewCamera::driver(double range, int width, int height) {
  ViewCamera camera{ViewKind::kDriver, width, height};
  camera.range = range;
  camera.focal = width / 2.0 / std::tan(kDriverFieldOfView / 2);
  camera.T_ego_camera.translation() = Vector3(-kDriverBack, 0, kDriverUp);
  const double c = std::cos(kDriverPitch), s = std::sin(kDriverPitch);
  camera.T_ego_camera.linear().col(0) = Vector3(0, -1, 0);
  camera.T_ego_camera.linear().col(1) = Vector3(-s, 0, -c);
  camera.T_ego_camera.linear().col(2) = Vector3(c, 0, -s);
  camera.far = std::max(200.0, 4 * range);
  return camera;
}

std::optional<Vector2> ViewCamera::project(const Vector3& point) const {
  const Vector3 optical = T_ego_camera.inverse() * point;
  if (optical.z() < near) return std::nullopt;
  return pixelOf(*this, optical);
}

std::optional<std::pair<Vector2, Vector2>> ViewCamera::project(const Vector3& a,
                                                               const Vector3& b) const {
  Vector3 p = T_ego_camera.inverse() * a, q = T_ego_camera.inverse() * b;
  if (p.z() < near && q.z() < near) return std::nullopt;
  if (p.z() < near) p += (near - p.z()) / (q.z() - p.z()) * (q - p);
  if (q.z() < near) q += (near - q.z()) / (p.z() - q.z()) * (p - q);
  return std::make_pair(pixelOf(*this, p), pixelOf(*this, q));
}

double ViewCamera::scaleAt(const Vector3& point) const {
  return focal / std::max(near, (T_ego_camera.inverse() * point).z());
}

}  // namespace perception
