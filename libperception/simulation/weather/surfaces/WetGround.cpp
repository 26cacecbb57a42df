#include "libperception/simulation/weather/surfaces/WetGround.h"

#include <algorithm>
#include <cmath>

#include "libperception/simulation/lidar/LidarSurface.h"
#include "libperception/simulation/weather/surfaces/Fresnel.h"
#include "libperception/simulation/world/World.h"

namespace perception {
namespace {

// Share of a beam's light that leaves, or of its sight that arrives, by the other one of the two
// paths (method.md 9.7, assumed).
constexpr double kStray = 0.05;
constexpr double kPulseLength = 0.75;  // [m] echoes nearer to each other are one
constexpr double kRoadLift = 0.01;     // [m] mirrored rays start above the road
constexpr double kMotion = 1;          // [m] of sensor and objects during a scan

}  // namespace

WetGround::WetGround(double film_mm, double object_factor)
    : wet_(wetShare(film_mm)), object_factor_(object_factor) {}

// Which objects a mirrored ray can meet, so that few are cast.
void WetGround::advance(const World& world, const SensorParams& sensor, double t) {
  if (!sensor.isLidar()) return;
  table_.reset((world.ego(t).T_world_ego * sensor.T_ego_sensor()).translation().head<2>());
  standers_.clear();
  for (std::size_t i = 0; i < world.objects(); ++i) {
    if (!world.present(i, t)) continue;
    const ObjectParams& object = world.scenario().objects[i];
    const Vector2 place = world.object(i, t).T_world_object.translation().head<2>();
    const double reach = .5 * std::hypot(object.length, object.width) + kMotion,
                 near = (place - table_.eye()).norm() - reach;
    if (near > sensor.lidar.range_max) continue;
    table_.add(place, reach, static_cast<std::uint32_t>(standers_.size()));
    standers_.push_back({std::max(0.0, near), object.base + object.height + 0.1});
  }
}

// `traveled` [m] horizontally up to the ground point.
bool WetGround::mayMeet(const Vector3& ground, const Vector3& direction, double traveled) const {
  const double slope = direction.z() / direction.head<2>().norm();
  const auto& items = table_.along(direction);
  return std::any_of(items.begin(), items.end(), [&](std::uint32_t item) {
    const Stander& s = standers_[item];
    return ground.z() + std::max(0.0, s.near - traveled) * slope < s.height;
  });
}

void WetGround::alter(const SensorParams& sensor, LidarPulse& pulse, Rng&) const {
  const Material material = pulse.hit.material;
  if (pulse.hit.object >= 0) return blend(pulse);
  if (pulse.hit.object != BeamHit::kRoad ||
      (material != Material::kRoad && material != Material::kPaint)) {
    return;
  }
  const double cosine = pulse.hit.cos_incidence;
  const double ground = lidarSurface(material).reflectivity;
  pulse.reflectivity *= 1 - wet_ + wet_ * filmFactor(ground, cosine);
  addMirrored(sensor, wet_ * waterReflectance(cosine).mean(), pulse);
}

// Two of the three kinds: both ways by the ground, and out direct and back by the ground. Both are
// on the beam's line behind the road.
void WetGround::addMirrored(const SensorParams& sensor, double mirror, LidarPulse& pulse) const {
  const double r1 = pulse.hit.range;
  const double bounce = std::max(mirror * mirror, kStray * mirror);
  if (!pulse.scene || bounce * 0.5 < pulse.reflectivity) return;  // the road's echo is stronger
  const Vector3 ground = pulse.origin + r1 * pulse.direction + kRoadLift * Vector3::UnitZ();
  Vector3 up = pulse.direction;
  up.z() = std::abs(up.z());
  if (!mayMeet(ground, up, (ground - pulse.origin).head<2>().norm())) return;
  const SurfaceHit hit = pulse.scene->surface(ground, up, sensor.lidar.range_max - r1);
  if (hit.object < 0) return;
  const auto& object =
      pulse.scene->world().scenario().objects[static_cast<std::size_t>(hit.object)];
  const double r2 = hit.range, direct = (ground + r2 * up - pulse.origin).norm();
  const double target = object_factor_ * object.reflectivity * lidarReflectivity(hit) *
                        (1 - lidarSurface(hit.material).lost),
               extinction = pulse.optical_depth / r1;
  const auto add = [&](double range, double share) {
    LidarPulse::Scatterer ghost;
    ghost.range = range;
    ghost.power = share * target * std::exp(-2 * extinction * range) / (range * range);
    ghost.phantom = Phantom::kMirror;
    pulse.scatterers.push_back(ghost);
  };
  add(r1 + r2, mirror * mirror);
  add(.5 * (r1 + r2 + direct), kStray * mirror);
}

// The third kind, out by the ground and back direct: little longer than the direct way, weaker and
// one echo with it, which moves it away.
void WetGround::blend(LidarPulse& pulse) const {
  const double direct = pulse.hit.range;
  const Vector3 place = pulse.origin + direct * pulse.direction;
  if (place.z() <= 0) return;
  const Vector3 by_ground = Vector3(place.x(), place.y(), -place.z()) - pulse.origin;
  const double longer = .5 * (by_ground.norm() - direct);
  if (longer >= kPulseLength) return;
  const double share =
      kStray * wet_ * waterReflectance(std::abs(by_ground.z()) / by_ground.norm()).mean();
  pulse.hit.range = static_cast<float>(direct + longer * share / (1 + share));
}

}  // namespace perception
