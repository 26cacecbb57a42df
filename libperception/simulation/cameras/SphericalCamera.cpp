#include "libperception/simulation/cameras/SphericalCamera.h"

#include <algorithm>
#include <cmath>

#include "libperception/measurement/models/CameraResolution.h"
#include "libperception/simulation/cameras/CameraBoxes.h"
#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/world/World.h"

namespace perception {
namespace {

constexpr std::uint32_t kPanoramaFalseSlot = 1u << 20,
                        kPanoramaWeatherPurpose = 0x57EA0000;  // random streams
constexpr double kRangeEdge = 0.1;  // recall falls from all to none within +-10 % of the range
constexpr double kPanoramaHidden = 0.15,
                 kPanoramaClear = 0.5;  // visible share: not found below, all above

/// Recall and label probabilities of a kind (method.md 2.3, camera columns).
struct Answer {
  double SphericalCameraParams::*recall;
  double SphericalCameraParams::*range;
  double as_car;  ///< probability of the label Car, else Pedestrian
};
Answer answerTo(ObjectKind kind) {
  using P = SphericalCameraParams;
  if (kind == ObjectKind::kPedestrian) return {&P::person_recall, &P::person_range, 0.02};
  if (kind == ObjectKind::kCyclist) return {&P::cyclist_recall, &P::person_range, 0.20};
  if (kind == ObjectKind::kBus) return {&P::bus_recall, &P::car_range, 0.97};
  return {&P::car_recall, &P::car_range, 0.98};
}

double panoramaRamp(double value, double low, double high) {
  return std::clamp((value - low) / (high - low), 0.0, 1.0);
}

bool valid(const ObjectDetection::ImageBox& b) { return b.x2 > b.x1 && b.y2 > b.y1; }

void shake(ObjectDetection::ImageBox& box, double noise, Rng& rng) {
  const double sigma = noise * (box.y2 - box.y1);
  for (double* edge : {&box.x1, &box.y1, &box.x2, &box.y2}) *edge += sigma * rng.normal();
}

double binned(double angle, int bins) {
  if (bins <= 0) return wrapAngle(angle);
  const double width = kTwoPi / bins;
  return wrapAngle(std::round(angle / width) * width);
}

std::optional<ObjectDetection> detectOne(const LidarCaster& caster, std::size_t object, double t,
                                         const SphericalCameraParams& p,
                                         const Pose3& T_world_camera, const RngKey& key,
                                         const CameraHook& hook) {
  const World& world = caster.world();
  const Answer answer = answerTo(world.scenario().objects[object].kind);
  const Pose3 T_world_object = world.object(object, t).T_world_object;
  const Vector3 sight = T_world_object.translation() - T_world_camera.translation();
  CameraLook look;
  look.object = object;
  look.range = sight.head<2>().norm();
  look.azimuth = std::atan2(sight.y(), sight.x());
  look.edge_noise = p.edge_noise;
  look.chance = panoramaRecall(p, world.scenario().objects[object].kind, look.range);
  if (hook) {
    Rng rng(key.withSlot(static_cast<std::uint32_t>(object))
                .withPurpose(key.purpose ^ kPanoramaWeatherPurpose));
    hook(look, rng);
    look.chance *= contrastRecall(look.optical_depth);
  }
  Rng rng(key.withSlot(static_cast<std::uint32_t>(object)));
  const double draw = rng.uniform();
  if (draw >= look.chance) return {};  // before the expensive occlusion test
  look.chance *= panoramaRamp(caster.visibleShare(T_world_camera.translation(), object),
                              kPanoramaHidden, kPanoramaClear);
  if (draw >= look.chance) return {};
  const CameraModel camera = p.model();
  const auto outline = imageOutline(world, object, t, camera, T_world_camera);
  if (!outline) return {};
  ObjectDetection d;
  auto box = outline->box;
  shake(box, look.edge_noise, rng);
  d.image_box = onPanorama(box, camera);
  if (!valid(*d.image_box)) return {};
  const bool as_car = rng.uniform() < answer.as_car;
  d.label = as_car ? "Car" : "Pedestrian";
  d.score = std::clamp(0.45 + 0.5 * look.chance + 0.08 * rng.normal(), 0.05, 1.0);
  if (p.heading && as_car) {
    const double alpha = observationAngle(T_world_camera.inverse() * T_world_object);
    const double flip = rng.uniform() < p.heading_flip ? kPi : 0;
    d.heading = binned(alpha + p.heading_noise * rng.normal(), p.heading_bins);
    d.heading = wrapAngle(*d.heading + flip);
  }
  return d;
}

// Half of the false boxes are on similar objects (poles as persons, bushes as cars) and recur in
// the next image, the rest is uniform on the ground within range.
std::optional<ObjectDetection> falseBox(const LidarCaster& caster, double t,
                                        const SphericalCameraParams& p, const Pose3& T_world_camera,
                                        Rng& rng) {
  constexpr double kOnThings = 0.5, kCars = 0.6;  // shares: on things; labeled Car
  const CameraModel camera = p.model();
  ObjectDetection d;
  d.score = rng.uniform(0.3, 0.7);
  const bool on_thing = rng.uniform() < kOnThings, as_car = rng.uniform() < kCars;
  d.label = as_car ? "Car" : "Pedestrian";
  const double range = as_car ? p.car_range : p.person_range;
  if (p.heading && as_car) d.heading = rng.uniform(-kPi, kPi);
  std::vector<std::size_t> alike;
  const auto& objects = caster.world().scenario().objects;
  for (std::size_t i = 0; on_thing && i < objects.size(); ++i) {
    const ObjectKind like = as_car ? ObjectKind::kBush : ObjectKind::kPole;
    const Vector3 place = caster.world().object(i, t).T_world_object.translation();
    if (objects[i].kind == like &&
        (place - T_world_camera.translation()).head<2>().norm() < range) {
      alike.push_back(i);
    }
  }
  if (!alike.empty()) {
    const std::size_t thing = alike[rng.below(static_cast<std::uint32_t>(alike.size()))];
    const auto outline = imageOutline(caster.world(), thing, t, camera, T_world_camera);
    if (!outline) return {};
    d.image_box = outline->box;
    shake(*d.image_box, p.edge_noise, rng);
  } else {
    const double far = range * std::sqrt(rng.uniform(0.05, 1));  // uniform over the ground
    const double height = rng.uniform(1.3, 1.9);                 // [m]
    const double width = as_car ? rng.uniform(1.7, 4.5) : rng.uniform(0.4, 0.8);  // [m]
    const double eye = T_world_camera.translation().z();
    const double u = rng.uniform(0, camera.width), half = .5 * camera.fx * width / far;
    d.image_box =
        ObjectDetection::ImageBox{u - half, camera.cy + camera.fy * std::atan2(eye - height, far),
                                  u + half, camera.cy + camera.fy * std::atan2(eye, far)};
  }
  d.image_box = onPanorama(*d.image_box, camera);
  if (!valid(*d.image_box)) return {};
  return d;
}

}  // namespace

double panoramaRecall(const SphericalCameraParams& params, ObjectKind kind, double range) {
  const Answer answer = answerTo(kind);
  const double reach = params.*answer.range;
  return params.*answer.recall *
         (1 - panoramaRamp(range, (1 - kRangeEdge) * reach, (1 + kRangeEdge) * reach));
}

ObjectDetection::ImageBox onPanorama(ObjectDetection::ImageBox b, const CameraModel& camera) {
  const double shift = std::floor(b.x1 / camera.width) * camera.width;
  b.x1 -= shift, b.x2 -= shift;
  b.y1 = std::clamp(b.y1, 0.0, camera.height - 1.0);
  b.y2 = std::clamp(b.y2, 0.0, camera.height - 1.0);
  return b;
}

void SphericalCameraParams::setResolution(Resolution r) {
  const CameraResolution& row = cameraResolutions()[static_cast<std::size_t>(r)];
  resolution = r;
  width = row.width, height = row.height;
  car_range = row.car_range, person_range = row.person_range;
  false_per_image = row.false_per_image;
}

void SphericalCameraParams::visit(ParamVisitor& v) {
  const Resolution before = resolution;
  v.choiceOf("resolution", resolution, cameraResolutionNames(),
             "sets size, ranges and false boxes [radecki2016]");
  if (resolution != before) setResolution(resolution);
  v.real("false_per_image", false_per_image, {0, 100}, "-", "boxes of no car or person");
  v.real("heading_flip", heading_flip, {0, 1}, "-", "share reversed by 180 deg");
  v.expert();
  v.boolean("heading", heading, "detector tells the orientation of cars");
}

CameraModel SphericalCameraParams::model() const {
  CameraModel m;
  m.projection = CameraModel::Projection::kEquirectangular;
  m.width = width, m.height = height;
  m.fx = width / kTwoPi, m.fy = height / kPi;
  m.cx = .5 * width, m.cy = .5 * height;
  return m;
}

ObjectDetections detectPanorama(const LidarCaster& caster, double t,
                                const SphericalCameraParams& params, const Pose3& T_world_camera,
                                const RngKey& key, const CameraHook& hook) {
  ObjectDetections result;
  result.camera = params.model();
  const auto& objects = caster.world().scenario().objects;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (!isRoadUser(objects[i].kind)) continue;
    if (auto d = detectOne(caster, i, t, params, T_world_camera, key, hook)) {
      result.objects.push_back(*d);
    }
  }
  Rng rng(key.withSlot(kPanoramaFalseSlot));
  for (int n = rng.poisson(params.false_per_image); n > 0; --n) {
    if (auto d = falseBox(caster, t, params, T_world_camera, rng)) result.objects.push_back(*d);
  }
  return result;
}

}  // namespace perception
