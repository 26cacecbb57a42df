#include "gui-offscreen/drawing/ViewCamera.h"

#include <algorithm>

namespace perception {
namespace {

constexpr double kTopHeight = 1000;  // [m] of the top view's pinhole
constexpr double kTopDepth = 60;     // [m] above and below the ground that it shows
constexpr double kBehind = 0.4;      // of the range that the top view shows behind the vehicle
constexpr double kDriverBack = 12, kDriverUp = 8;   // [m] from the ego origin
constexpr double kDriverPitch = radians(20);        // down
constexpr double kDriverFieldOfView = radians(72);  // horizontal

constexpr double kImageNear = 0.3;     // [m] before a camera of the vehicle
constexpr double kPiece = radians(3);  // of a line in a panorama that is drawn straight

bool isPanorama(const ViewCamera& camera) {
  return camera.projection == CameraModel::Projection::kEquirectangular;
}

Vector2 pixelOf(const ViewCamera& camera, const Vector3& optical) {
  Vector2 at(optical.x() / optical.z(), optical.y() / optical.z());
  if (isPanorama(camera)) {
    at = Vector2(std::atan2(optical.x(), optical.z()),
                 std::atan2(optical.y(), std::hypot(optical.x(), optical.z())));
  }
  return camera.center + Vector2(camera.focal * at.x(), camera.focal_y * at.y());
}

// A camera with square pixels and centered principal point.
void centerAxis(ViewCamera& camera, double focal) {
  camera.focal = camera.focal_y = focal;
  camera.center = Vector2(camera.width / 2.0, camera.height / 2.0);
}

}  // namespace

ViewCamera ViewCamera::top(double range, int width, int height) {
  ViewCamera camera{ViewKind::kTop, width, height};
  camera.range = range;
  centerAxis(camera, height / ((1 + kBehind) * range) * kTopHeight);
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
  centerAxis(camera, width / 2.0 / std::tan(kDriverFieldOfView / 2));
  camera.T_ego_camera.translation() = Vector3(-kDriverBack, 0, kDriverUp);
  const double c = std::cos(kDriverPitch), s = std::sin(kDriverPitch);
  camera.T_ego_camera.linear().col(0) = Vector3(0, -1, 0);
  camera.T_ego_camera.linear().col(1) = Vector3(-s, 0, -c);
  camera.T_ego_camera.linear().col(2) = Vector3(c, 0, -s);
  camera.far = std::max(200.0, 4 * range);
  return camera;
}

ViewCamera ViewCamera::image(const CameraModel& model, const Pose3& T_ego_camera, double scale) {
  ViewCamera camera{ViewKind::kCamera, static_cast<int>(std::lround(model.width * scale)),
                    static_cast<int>(std::lround(model.height * scale))};
  camera.focal = model.fx * scale;
  camera.focal_y = model.fy * scale;
  camera.center = Vector2(model.cx, model.cy) * scale;
  camera.projection = model.projection;
  camera.T_ego_camera = T_ego_camera;
  camera.near = kImageNear;
  return camera;
}

std::optional<Vector2> ViewCamera::project(const Vector3& point) const {
  const Vector3 optical = T_ego_camera.inverse() * point;
  const double depth = isPanorama(*this) ? optical.norm() : optical.z();
  if (!(depth >= near)) return std::nullopt;
  return pixelOf(*this, optical);
}

std::vector<std::pair<Vector2, Vector2>> ViewCamera::projectLine(const Vector3& a,
                                                                 const Vector3& b) const {
  if (isPanorama(*this)) {
    const Vector3 p = T_ego_camera.inverse() * a, q = T_ego_camera.inverse() * b;
    if (!(std::min(p.norm(), q.norm()) >= near)) return {};
    const double angle = std::acos(std::clamp(p.normalized().dot(q.normalized()), -1.0, 1.0));
    const int pieces = 1 + static_cast<int>(angle / kPiece);
    std::vector<std::pair<Vector2, Vector2>> lines;
    Vector2 last = pixelOf(*this, p);
    for (int i = 1; i <= pieces; ++i) {
      const Vector2 next = pixelOf(*this, p + static_cast<double>(i) / pieces * (q - p));
      if (std::abs(next.x() - last.x()) < kPi * focal) lines.emplace_back(last, next);
      last = next;
    }
    return lines;
  }
  Vector3 p = T_ego_camera.inverse() * a, q = T_ego_camera.inverse() * b;
  if (p.z() < near && q.z() < near) return {};
  if (p.z() < near) p += (near - p.z()) / (q.z() - p.z()) * (q - p);
  if (q.z() < near) q += (near - q.z()) / (p.z() - q.z()) * (p - q);
  return {{pixelOf(*this, p), pixelOf(*this, q)}};
}

double ViewCamera::scaleAt(const Vector3& point) const {
  return focal / std::max(near, (T_ego_camera.inverse() * point).z());
}

}  // namespace perception
