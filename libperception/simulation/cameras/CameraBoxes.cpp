#include "libperception/simulation/cameras/CameraBoxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/world/World.h"

namespace perception {
namespace {

constexpr std::array<const char*, 3> kLabels = {"Car", "Pedestrian", "Cyclist"};  // KITTI's types
constexpr double kNearPlane = 0.2;  // [m] what lies nearer to the lens is not projected
constexpr double kHidden = 0.15,
                 kClear = 0.5;                         // visible share: P_D 0 below, full above
constexpr std::uint32_t kFalseSlot = 1u << 20;         // random streams of false boxes
constexpr std::uint32_t kWeatherPurpose = 0x57EA0000;  // of weather

std::size_t labelOf(ObjectKind kind) {
  if (kind == ObjectKind::kPedestrian) return 1;
  return kind == ObjectKind::kCyclist ? 2 : 0;
}

double ramp(double value, double low, double high) {
  return std::clamp((value - low) / (high - low), 0.0, 1.0);
}

double area(const ObjectDetection::ImageBox& b) {
  return std::max(0.0, b.x2 - b.x1) * std::max(0.0, b.y2 - b.y1);
}

ObjectDetection::ImageBox clipped(ObjectDetection::ImageBox b, const CameraModel& camera) {
  b.x1 = std::clamp(b.x1, 0.0, camera.width - 1.0),
  b.x2 = std::clamp(b.x2, 0.0, camera.width - 1.0);
  b.y1 = std::clamp(b.y1, 0.0, camera.height - 1.0);
  b.y2 = std::clamp(b.y2, 0.0, camera.height - 1.0);
  return b;
}

std::optional<ObjectDetection> detectOne(const LidarCaster& caster, std::size_t object, double t,
                                         const CameraParams& p, const Pose3& T_world_camera,
                                         const RngKey& key, const CameraHook& hook) {
  Rng rng(key);
  const World& world = caster.world();
  const ObjectKind kind = world.scenario().objects[object].kind;
  const CameraModel camera = p.model();
  const auto outline = imageOutline(world, object, t, camera, T_world_camera);
  if (!outline) return {};
  const double height = outline->box.y2 - outline->box.y1;
  const double visible = caster.visibleShare(T_world_camera.translation(), object);
  CameraLook look;
  look.object = object;
  const Vector3 sight =
      world.object(object, t).T_world_object.translation() - T_world_camera.translation();
  look.range = sight.head<2>().norm();
  look.azimuth = std::atan2(sight.y(), sight.x());
  look.edge_noise = p.edge_noise;
  look.chance = boxRecall(p, height) * ramp(visible, kHidden, kClear) * (1 - outline->truncated);
  if (hook) {
    Rng weather_rng(key.withPurpose(key.purpose ^ kWeatherPurpose));
    hook(look, weather_rng);
    look.chance *= contrastRecall(look.optical_depth);
  }
  if (rng.uniform() >= look.chance) return {};
  ObjectDetection d;
  auto box = outline->box;
  for (double* edge : {&box.x1, &box.y1, &box.x2, &box.y2}) {
    *edge += look.edge_noise * height * rng.normal();
  }
  d.image_box = clipped(box, camera);
  if (area(*d.image_box) <= 0) return {};
  std::size_t label = labelOf(kind);
  if (rng.uniform() < p.confusion) label = (label + 1 + rng.below(2)) % kLabels.size();
  d.label = kLabels[label];
  d.score = std::clamp(0.55 + 0.4 * look.chance + 0.05 * rng.normal(), 0.05, 1.0);
  if (p.heading && label == 0) {
    const Pose3 T_camera_object = T_world_camera.inverse() * world.object(object, t).T_world_object;
    const double flip = rng.uniform() < p.heading_flip ? kPi : 0;
    d.heading =
        wrapAngle(observationAngle(T_camera_object) + flip + p.heading_noise * rng.normal());
  }
  return d;
}

// A false box in the lower half of the image, of the size of a person or a car.
ObjectDetection falseBox(const CameraModel& camera, Rng& rng) {
  ObjectDetection d;
  const std::size_t label = rng.below(kLabels.size());
  const double height = camera.height * rng.uniform(0.08, 0.35);
  const double width = height * (label == 0 ? rng.uniform(1.0, 2.5) : rng.uniform(0.35, 0.9));
  const double x = rng.uniform(0, camera.width - 1.0),
               bottom = camera.height * rng.uniform(.55, .95);
  d.image_box = clipped({x - width / 2, bottom - height, x + width / 2, bottom}, camera);
  d.label = kLabels[label];
  d.score = rng.uniform(0.3, 0.7);
  return d;
}

}  // namespace

void CameraParams::visit(ParamVisitor& v) {
  v.integer("width", width, {16, 20000}, "of the image, pixels");
  v.integer("height", height, {16, 20000}, "of the image, pixels");
  v.angle("fov_deg", fov, {5, 150}, "horizontal");
  v.real("recall", recall, {0, 1}, "-", "of objects that are wholly visible and large");
  v.real("confusion", confusion, {0, 1}, "-", "share of wrong labels");
  v.real("false_per_image", false_per_image, {0, 100}, "-", "boxes where nothing is");
  v.real("heading_flip", heading_flip, {0, 1}, "-", "share reversed by 180 deg");
  v.expert();
  v.boolean("heading", heading, "detector tells the orientation of vehicles");
}

CameraModel CameraParams::model() const {
  CameraModel m;
  m.width = width, m.height = height;
  m.fx = m.fy = .5 * width / std::tan(.5 * fov);
  m.cx = .5 * width, m.cy = .5 * height;
  return m;
}

Pose3 opticalAxes() {
  Pose3 pose = Pose3::Identity();
  pose.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return pose;
}

double observationAngle(const Pose3& T_camera_object) {
  const Vector3 p = T_camera_object.translation(), axis = T_camera_object.linear().col(0);
  return wrapAngle(std::atan2(-axis.z(), axis.x()) - std::atan2(p.x(), p.z()));
}

double boxRecall(const CameraParams& params, double height) {
  return params.recall * ramp(height, params.min_pixels, params.full_pixels);
}

double recallAtContrast(double contrast) { return std::clamp((contrast - 0.05) / 0.2, 0.0, 1.0); }

double contrastRecall(double optical_depth) { return recallAtContrast(std::exp(-optical_depth)); }

std::optional<ImageOutline> imageOutline(const World& world, std::size_t object, double t,
                                         const CameraModel& camera, const Pose3& T_world_camera,
                                         const MirrorImage& mirror) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  ObjectDetection::ImageBox whole{kInfinity, kInfinity, -kInfinity, -kInfinity};
  const std::vector<Pose3> poses = world.parts(object, t);
  const bool panorama = camera.projection == CameraModel::Projection::kEquirectangular;
  // A panorama's columns are counted from the object's middle: it is whole on the seam, too.
  const Pose3 T_camera_world = T_world_camera.inverse();
  const auto seen = [&](const Vector3& p) { return T_camera_world * (mirror ? mirror(p) : p); };
  const Vector3 center = seen(world.object(object, t).T_world_object.translation());
  const double middle = std::atan2(center.x(), center.z());
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Pose3 T_camera_part = T_camera_world * poses[k];
    for (const auto& vertex : world.shape(object).parts[k].mesh.vertices) {
      const Vector3 on_part(vertex[0], vertex[1], vertex[2]);
      const Vector3 p = mirror ? seen(poses[k] * on_part) : T_camera_part * on_part;
      if (panorama) {
        const double azimuth = middle + wrapAngle(std::atan2(p.x(), p.z()) - middle);
        const double u = camera.cx + camera.fx * azimuth,
                     v = camera.cy + camera.fy * std::atan2(p.y(), std::hypot(p.x(), p.z()));
        whole = {std::min(whole.x1, u), std::min(whole.y1, v), std::max(whole.x2, u),
                 std::max(whole.y2, v)};
        continue;
      }
      if (p.z() < kNearPlane) continue;
      const double u = camera.cx + camera.fx * p.x() / p.z(),
                   v = camera.cy + camera.fy * p.y() / p.z();
      whole = {std::min(whole.x1, u), std::min(whole.y1, v), std::max(whole.x2, u),
               std::max(whole.y2, v)};
    }
  }
  if (!(whole.x2 > whole.x1)) return {};
  ImageOutline outline;
  outline.box = whole;
  if (panorama) return outline;
  outline.box = clipped(whole, camera);
  if (area(outline.box) <= 0) return {};
  outline.truncated = std::clamp(1 - area(outline.box) / area(whole), 0.0, 1.0);
  return outline;
}

ObjectDetections detectBoxes(const LidarCaster& caster, double t, const CameraParams& params,
                             const Pose3& T_world_camera, const RngKey& key,
                             const CameraHook& hook) {
  ObjectDetections result;
  result.camera = params.model();
  const auto& objects = caster.world().scenario().objects;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (!isRoadUser(objects[i].kind)) continue;
    const RngKey own = key.withSlot(static_cast<std::uint32_t>(i));
    if (auto d = detectOne(caster, i, t, params, T_world_camera, own, hook)) {
      result.objects.push_back(*d);
    }
  }
  Rng rng(key.withSlot(kFalseSlot));
  for (int n = rng.poisson(params.false_per_image); n > 0; --n) {
    result.objects.push_back(falseBox(result.camera, rng));
  }
  return result;
}

}  // namespace perception
