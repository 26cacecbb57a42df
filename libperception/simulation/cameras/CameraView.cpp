#include "libperception/simulation/cameras/CameraView.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

// Electrons of a full pixel at gain 1, and the deviation of reading it (assumed, of small pixels).
constexpr double kFullWell = 20000, kReadNoise = 10;
constexpr double kNearest = 0.01;  // [m] before the camera

}  // namespace

Vector3 opticalRay(const CameraModel& camera, double u, double v) {
  const double x = (u - camera.cx) / camera.fx, y = (v - camera.cy) / camera.fy;
  if (camera.projection == CameraModel::Projection::kEquirectangular) {
    return {std::cos(y) * std::sin(x), std::sin(y), std::cos(y) * std::cos(x)};
  }
  return Vector3(x, y, 1).normalized();
}

Vector3 CameraView::ray(double u, double v) const {
  return T_world_camera.linear() * opticalRay(camera, u, v);
}

std::optional<Vector2> CameraView::pixelOf(const Vector3& p) const {
  if (camera.projection == CameraModel::Projection::kEquirectangular) {
    const double x = std::atan2(p.x(), p.z()), y = std::atan2(p.y(), std::hypot(p.x(), p.z()));
    return Vector2(camera.cx + camera.fx * x, camera.cy + camera.fy * y);
  }
  if (p.z() < kNearest) return std::nullopt;
  return Vector2(camera.cx + camera.fx * p.x() / p.z(), camera.cy + camera.fy * p.y() / p.z());
}

// Electrons are in proportion to exposure times radiance, of which 1 fills the pixel.
void addSensorNoise(CameraView& view, Rng& rng) {
  const Lighting& light = view.light;
  if (light.gain <= 1) return;
  const double electrons = kFullWell / light.gain;
  for (Eigen::Vector3f& value : view.linear) {
    Rgb radiance = light.radianceOf(value.cast<double>());
    for (int c = 0; c < 3; ++c) {
      const double expected = radiance(c) * light.exposure * electrons;
      const double sigma = std::sqrt(expected + kReadNoise * kReadNoise);
      radiance(c) = std::max(0.0, expected + sigma * rng.normal()) / (light.exposure * electrons);
    }
    value = light.exposed(radiance).cast<float>();
  }
}

Raster rasterOf(const CameraView& view) {
  Raster raster{view.camera.width, view.camera.height, 3, {}};
  raster.pixels.reserve(3 * view.linear.size());
  for (const Eigen::Vector3f& value : view.linear)  // blue, green, red
    for (int c = 2; c >= 0; --c) raster.pixels.push_back(displayByte(value(c)));
  return raster;
}

}  // namespace perception
