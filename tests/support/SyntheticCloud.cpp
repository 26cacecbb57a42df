#include "tests/support/SyntheticCloud.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace perception::test {

namespace {

constexpr double kNoHit = std::numeric_limits<double>::infinity();

double hitGround(const GroundPlane& ground, const Vector3& o, const Vector3& d) {
  const double descent = d.z() - ground.a * d.x() - ground.b * d.y();
  const double t = (ground.heightAt(o.x(), o.y()) - o.z()) / descent;
  return descent < 0 && t > 0 ? t : kNoHit;
}

double hitCylinder(const SolidCylinder& cylinder, const Vector3& o, const Vector3& d) {
  const Vector2 o2 = o.head<2>() - cylinder.center, d2 = d.head<2>();
  const double a = d2.squaredNorm(), b = o2.dot(d2),
               c = o2.squaredNorm() - cylinder.radius * cylinder.radius;
  const double root = b * b - a * c;
  if (root < 0) return kNoHit;
  const double t = (-b - std::sqrt(root)) / a, z = o.z() + t * d.z();
  return t > 0 && z > cylinder.bottom && z < cylinder.top ? t : kNoHit;
}

}  // namespace

double rangeToBox(const SolidBox& box, const Vector3& o, const Vector3& d) {
  const Vector2 o2 = rotate2(-box.yaw, o.head<2>() - box.center),
                d2 = rotate2(-box.yaw, d.head<2>());
  const double origin[3] = {o2.x(), o2.y(), o.z()}, along[3] = {d2.x(), d2.y(), d.z()};
  const double low[3] = {-box.length / 2, -box.width / 2, box.bottom};
  const double high[3] = {box.length / 2, box.width / 2, box.top};
  double in = 0, out = kNoHit;
  for (int k = 0; k < 3; ++k) {
    const double t1 = (low[k] - origin[k]) / along[k], t2 = (high[k] - origin[k]) / along[k];
    in = std::max(in, std::min(t1, t2)), out = std::min(out, std::max(t1, t2));
  }
  return in < out && in > 0 ? in : kNoHit;
}

SensorFrame castScan(const SolidScene& scene, const SpinningLidar& lidar, Stamp stamp,
                     std::uint64_t seed) {
  SensorFrame frame;
  frame.sensor = "LIDAR_TOP";
  frame.stamp = stamp;
  frame.ego.stamp = stamp;
  frame.T_ego_sensor = lidar.T_ego_sensor;
  frame.ground = scene.ground;
  LidarCloud cloud;
  Rng rng(RngKey{seed, static_cast<std::uint64_t>(stamp.ns), 0, 0x74657374});
  const Vector3 origin = lidar.T_ego_sensor.translation();
  const int steps = static_cast<int>(std::floor(lidar.fov / lidar.azimuth_step));
  for (int beam = 0; beam < lidar.beams; ++beam) {
    const double elevation =
        lidar.lowest + (lidar.highest - lidar.lowest) * beam / (lidar.beams - 1);
    for (int step = 0; step < steps; ++step) {
      const double azimuth = -lidar.fov / 2 + (step + 0.5) * lidar.azimuth_step;
      const Vector3 ray(std::cos(elevation) * std::cos(azimuth),
                        std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const Vector3 direction = lidar.T_ego_sensor.linear() * ray;
      double range = hitGround(scene.ground, origin, direction);
      for (const SolidBox& box : scene.boxes)
        range = std::min(range, rangeToBox(box, origin, direction));
      for (const SolidCylinder& c : scene.cylinders)
        range = std::min(range, hitCylinder(c, origin, direction));
      if (!(range < lidar.range_max)) continue;
      const Vector3 p = ray * (range + rng.normal(0, lidar.range_sigma));
      cloud.x.push_back(static_cast<float>(p.x()));
      cloud.y.push_back(static_cast<float>(p.y()));
      cloud.z.push_back(static_cast<float>(p.z()));
    }
  }
  frame.data = std::move(cloud);
  return frame;
}

}  // namespace perception::test
