#include "libperception/simulation/weather/surfaces/ShopWindows.h"

#include <cmath>
#include <variant>

#include "libperception/simulation/lidar/LidarSurface.h"
#include "libperception/simulation/weather/surfaces/Fresnel.h"
#include "libperception/simulation/world/Appearance.h"
#include "libperception/simulation/world/World.h"

namespace perception {
namespace {

constexpr double kPane = 2.5;                 // [m] width (assumed)
constexpr double kSill = 0.5, kLintel = 3;    // [m] above the house's foot (assumed)
constexpr double kOff = 0.01;                 // [m] mirrored rays start before the glass
constexpr std::uint32_t kPanes = 0x57EA4000;  // purpose of random numbers
constexpr double kLeastMirrorScore = 0.3,
                 kMostMirrorScore = 0.7;  // as of other false boxes, assumed

Vector3 mirrored(Vector3 p, int axis, double offset) {
  p[axis] = 2 * offset - p[axis];
  return p;
}

bool outside(const Vector3& p, int axis, double offset) {
  return offset > 0 ? p[axis] > offset : p[axis] < offset;
}

// Share of such objects that the camera's detector finds in clear air.
double found(const SensorParams& sensor, ObjectKind kind, double range, double height) {
  return sensor.kind == SensorKind::kSphericalCamera ? panoramaRecall(sensor.panorama, kind, range)
                                                     : boxRecall(sensor.camera, height);
}

// A panorama's detector knows two labels.
const char* labelOf(const SensorParams& sensor, ObjectKind kind) {
  if (kind == ObjectKind::kPedestrian) return "Pedestrian";
  if (kind != ObjectKind::kCyclist) return "Car";
  return sensor.kind == SensorKind::kSphericalCamera ? "Pedestrian" : "Cyclist";
}

}  // namespace

ShopWindows::ShopWindows(double share, std::uint64_t seed) : share_(share), seed_(seed) {}

void ShopWindows::advance(const World& world, const SensorParams&, double t) {
  world_ = &world, t_ = t;
  fronts_.clear();
  for (std::size_t i = 0; i < world.objects(); ++i) {
    const ObjectParams& o = world.scenario().objects[i];
    if (!isHouse(o) || o.base > 0 || !world.present(i, t)) continue;
    const Pose3 T = world.object(i, t).T_world_object;
    for (const double side : {1., -1.}) {
      fronts_.push_back({i, 0, side * o.length / 2, o.width / 2, T});
      fronts_.push_back({i, 1, side * o.width / 2, o.length / 2, T});
    }
  }
}

bool ShopWindows::isGlass(const Front& front, const Vector3& on_front) const {
  const double along = on_front[1 - front.axis];
  if (on_front.z() < kSill || on_front.z() > kLintel || std::abs(along) > front.half) return false;
  const auto pane = static_cast<std::uint32_t>((along + front.half) / kPane);
  const std::uint32_t face = 2u * static_cast<std::uint32_t>(front.axis) + (front.offset > 0);
  return Rng({seed_, 4 * front.house + face, pane, kPanes}).uniform() < share_;
}

// Of the two mirror paths the one both ways by the glass: an object behind it, as far as the way.
void ShopWindows::alter(const SensorParams& sensor, LidarPulse& pulse, Rng&) const {
  if (pulse.hit.object < 0 || pulse.hit.material != Material::kWall || !pulse.scene) return;
  const double r1 = pulse.hit.range;
  const Vector3 place = pulse.origin + r1 * pulse.direction;
  for (const Front& front : fronts_) {
    if (front.house != static_cast<std::size_t>(pulse.hit.object)) continue;
    const Vector3 local = front.T_world_house.inverse() * place;
    if (std::abs(local[front.axis] - front.offset) > kOff || !isGlass(front, local)) continue;
    const LidarSurface& glass = lidarSurface(Material::kGlass);
    const double cosine = pulse.hit.cos_incidence;
    pulse.hit.material = Material::kGlass;
    pulse.reflectivity = lidarReflectivity(pulse.hit), pulse.lost = glass.lost;
    const Vector3 normal =
        front.T_world_house.linear().col(front.axis) * (front.offset > 0 ? 1 : -1);
    const Vector3 away = pulse.direction - 2 * pulse.direction.dot(normal) * normal;
    const SurfaceHit hit =
        pulse.scene->surface(place + kOff * normal, away, sensor.lidar.range_max - r1);
    if (hit.object < 0) return;
    const auto& object =
        pulse.scene->world().scenario().objects[static_cast<std::size_t>(hit.object)];
    const double mirror = glassReflectance(cosine), range = r1 + hit.range;
    LidarPulse::Scatterer ghost;
    ghost.range = range;
    ghost.power = mirror * mirror * object.reflectivity * lidarReflectivity(hit) *
                  (1 - lidarSurface(hit.material).lost) *
                  std::exp(-2 * pulse.optical_depth / r1 * range) / (range * range);
    ghost.phantom = Phantom::kMirror;
    pulse.scatterers.push_back(ghost);
    return;
  }
}

std::optional<ShopWindows::Image> ShopWindows::imageIn(const Front& front, const Vector3& camera,
                                                       const Vector3& object) const {
  const Pose3 T_house_world = front.T_world_house.inverse();
  const Vector3 eye = T_house_world * camera, real = T_house_world * object;
  if (!outside(eye, front.axis, front.offset) || !outside(real, front.axis, front.offset))
    return {};
  const Vector3 way = mirrored(real, front.axis, front.offset) - eye;
  const double part = (front.offset - eye[front.axis]) / way[front.axis];
  if (!isGlass(front, eye + part * way)) return {};
  return Image{way.norm(), glassReflectance(std::abs(way[front.axis]) / way.norm())};
}

void ShopWindows::addBox(const SensorParams& sensor, const Front& front, std::size_t object,
                         const Image& image, const Pose3& T_world_camera,
                         ObjectDetections& detections, Rng& rng) const {
  const Pose3 T_house_world = front.T_world_house.inverse();
  const auto mirror = [&](const Vector3& p) {
    return front.T_world_house * mirrored(T_house_world * p, front.axis, front.offset);
  };
  const auto outline = imageOutline(*world_, object, t_, detections.camera, T_world_camera, mirror);
  if (!outline) return;
  const ObjectKind kind = world_->scenario().objects[object].kind;
  const double height = outline->box.y2 - outline->box.y1;
  const double chance = found(sensor, kind, image.path, height) *
                        recallAtContrast(image.reflectance) * (1 - outline->truncated);
  if (rng.uniform() >= chance) return;
  ObjectDetection d;
  d.label = labelOf(sensor, kind);
  d.score = rng.uniform(kLeastMirrorScore, kMostMirrorScore);
  d.image_box = sensor.kind == SensorKind::kSphericalCamera
                    ? onPanorama(outline->box, detections.camera)
                    : outline->box;
  detections.objects.push_back(d);
}

void ShopWindows::alter(const SensorParams& sensor, SensorFrame& frame, Rng& rng) const {
  auto* detections = std::get_if<ObjectDetections>(&frame.data);
  if (!detections || !world_) return;
  const Pose3 T_world_camera = world_->ego(t_).T_world_ego * frame.T_ego_sensor;
  for (std::size_t i = 0; i < world_->objects(); ++i) {
    const ObjectParams& object = world_->scenario().objects[i];
    if (!isRoadUser(object.kind) || !world_->present(i, t_)) continue;
    const Vector3 middle = world_->object(i, t_).T_world_object.translation() +
                           Vector3(0, 0, object.base + object.height / 2);
    for (const Front& front : fronts_)
      if (const auto image = imageIn(front, T_world_camera.translation(), middle))
        addBox(sensor, front, i, *image, T_world_camera, *detections, rng);
  }
}

}  // namespace perception
