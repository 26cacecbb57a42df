#include "libperception/scene/files/KittiExport.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libperception/core/math/LogMath.h"
#include "libperception/scene/files/NumberFormat.h"

namespace perception {
namespace {

constexpr double kNearPlane = 0.1;  // [m] near plane of the projection
constexpr int kPixelPlaces = 2;     // as in KITTI's own files
constexpr double kSurest =
    1e-6;  // bound of the existence probability in the score: resolution of tracks.csv

// Corners of the box in the reference frame; bit 0: front, bit 1: right, bit 2: top. The frame's y
// axis points down.
std::array<Vector3, 8> corners(const KittiObject& o) {
  const Vector3 forward(std::cos(o.rotation_y), 0, -std::sin(o.rotation_y));
  const Vector3 right(std::sin(o.rotation_y), 0, std::cos(o.rotation_y));
  std::array<Vector3, 8> result;
  for (std::size_t i = 0; i < 8; ++i) {
    result[i] = o.bottom_center + ((i & 1) ? 0.5 : -0.5) * o.length * forward +
                ((i & 2) ? 0.5 : -0.5) * o.width * right -
                ((i & 4) ? o.height : 0) * Vector3::UnitY();
  }
  return result;
}

// Bounding box of the points added.
struct Outline {
  double x1 = 1e9, y1 = 1e9, x2 = -1e9, y2 = -1e9;  // [px]
  void add(const Vector3& p, const CameraModel& camera) {
    const double u = camera.fx * p.x() / p.z() + camera.cx,
                 v = camera.fy * p.y() / p.z() + camera.cy;
    x1 = std::min(x1, u), x2 = std::max(x2, u);
    y1 = std::min(y1, v), y2 = std::max(y2, v);
  }
};

// Image box of the 3D box, given in the camera's frame: its edges are clipped at the near plane,
// the result at the image; empty if less than the given share is inside.
std::optional<ObjectDetection::ImageBox> project(const std::array<Vector3, 8>& corner,
                                                 const CameraModel& camera, double in_image) {
  Outline outline;
  for (std::size_t i = 0; i < 8; ++i) {
    if (corner[i].z() >= kNearPlane) outline.add(corner[i], camera);
    for (const std::size_t bit : {1u, 2u, 4u}) {
      const Vector3 &a = corner[i], &b = corner[i | bit];
      if ((i & bit) == 0 && (a.z() < kNearPlane) != (b.z() < kNearPlane)) {
        outline.add(a + (kNearPlane - a.z()) / (b.z() - a.z()) * (b - a), camera);
      }
    }
  }
  ObjectDetection::ImageBox box;
  box.x1 = std::max(outline.x1, 0.0), box.x2 = std::min(outline.x2, camera.width - 1.0);
  box.y1 = std::max(outline.y1, 0.0), box.y2 = std::min(outline.y2, camera.height - 1.0);
  if (!(box.x1 < box.x2 && box.y1 < box.y2)) return std::nullopt;
  const double whole = (outline.x2 - outline.x1) * (outline.y2 - outline.y1);
  if ((box.x2 - box.x1) * (box.y2 - box.y1) < in_image * whole) return std::nullopt;
  return box;
}

// Class that an object is written as: its most probable one, or, if that is not a road user, the
// most probable road-user class from road_user_from on; a low score then lets a threshold decide.
struct Role {
  ClassId class_id = 0;
  double probability = 0;  // that it exists and is of such a kind
};

Role roleOf(const SceneObject& object, const ClassTable& classes, double road_user_from) {
  if (object.class_probability.empty()) return {object.class_id, object.existence};
  double road_user = 0;
  ClassId best = -1;
  const auto p = [&](ClassId c) { return object.class_probability[static_cast<std::size_t>(c)]; };
  for (ClassId c = 0; c < classes.size(); ++c) {
    if (!classes[c].reported) continue;
    road_user += p(c);
    if (best < 0 || p(c) > p(best)) best = c;
  }
  const bool thing = !classes[object.class_id].reported;
  if (best < 0 || (thing && road_user * object.existence < road_user_from))
    return {object.class_id, object.existence * (1 - road_user)};
  return {best, object.existence * road_user};
}

// A heading of nearly uniform distribution does not determine the outline.
bool headingKnown(const SceneObject& object) {
  constexpr double kUnknown = 1.2;  // [rad] of a heading that is uniform as an axis: pi / sqrt(12)
  return object.has_yaw && object.sd_yaw < kUnknown;
}

// Without a heading the object is a disc of the mean diameter, as in the measurement models;
// written as a square facing the line of sight with the same angular width.
void takeAsDisc(KittiObject& o) {
  const double radius = 0.25 * (o.length + o.width);
  const double range = std::hypot(o.bottom_center.x(), o.bottom_center.z());
  const double half = std::asin(std::min(0.9, radius / std::max(range, 1e-3)));
  // Half side a of the square with a / (range - a) = tan(half).
  o.length = o.width = 2 * range * std::tan(half) / (1 + std::tan(half));
  o.rotation_y = wrapAngle(std::atan2(o.bottom_center.x(), o.bottom_center.z()) - kPi / 2);
}

}  // namespace

std::optional<KittiObject> kittiObject(const SceneObject& object, const Scene& scene,
                                       const ClassTable& classes, const KittiCamera& camera,
                                       const KittiSelection& selection) {
  const Pose3 T_world_camera = scene.ego.T_world_ego * camera.T_ego_camera;
  const Pose3 T_reference_world =
      (T_world_camera * Eigen::Translation3d(camera.reference_in_camera)).inverse();
  KittiObject result;
  result.frame = scene.frame;
  result.id = object.id;
  const Role role = roleOf(object, classes, selection.road_user_from);
  result.type = classes[role.class_id].kitti_type;
  result.length = object.length, result.width = object.width, result.height = object.height;
  result.bottom_center = T_reference_world * object.position;
  if (headingKnown(object)) {
    const Vector3 front =
        T_reference_world.linear() * Vector3(std::cos(object.yaw), std::sin(object.yaw), 0);
    result.rotation_y = std::atan2(-front.z(), front.x());
  } else {
    takeAsDisc(result);
  }
  result.alpha =
      wrapAngle(result.rotation_y - std::atan2(result.bottom_center.x(), result.bottom_center.z()));
  result.score = logit(std::clamp(role.probability, kSurest, 1 - kSurest));

  std::array<Vector3, 8> in_camera = corners(result);
  for (Vector3& corner : in_camera) corner += camera.reference_in_camera;
  const auto box = project(in_camera, camera.camera, selection.in_image);
  if (!box) return std::nullopt;
  result.box = *box;
  return result;
}

std::string kittiLine(const KittiObject& o) {
  std::string line =
      fmt::format("{} {} {} 0 0 {}", o.frame, o.id, o.type, fixedPlaces(o.alpha, kRadianPlaces));
  for (const double v : {o.box.x1, o.box.y1, o.box.x2, o.box.y2})
    line += ' ' + fixedPlaces(v, kPixelPlaces);
  for (const double v : {o.height, o.width, o.length}) line += ' ' + fixedPlaces(v, kMeterPlaces);
  for (const double v : o.bottom_center) line += ' ' + fixedPlaces(v, kMeterPlaces);
  line += ' ' + fixedPlaces(o.rotation_y, kRadianPlaces);
  return line + ' ' + fixedPlaces(o.score, kProbabilityPlaces) + '\n';
}

KittiExport::KittiExport(const std::string& path, const ClassTable& classes,
                         const KittiCamera& camera, const KittiSelection& selection)
    : file_(path), classes_(classes), camera_(camera), selection_(selection) {}

void KittiExport::write(const Scene& scene) {
  if (scene.frame < 0) return;
  for (const SceneObject& object : scene.objects) {
    if (const auto seen = kittiObject(object, scene, classes_, camera_, selection_))
      file_.write(kittiLine(*seen));
  }
}

void KittiExport::close() { file_.close(); }

}  // namespace perception
