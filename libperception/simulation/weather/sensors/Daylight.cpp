#include "libperception/simulation/weather/sensors/Daylight.h"

#include <cmath>
#include <limits>

#include "libperception/core/math/Angle.h"
#include "libperception/simulation/cameras/CameraView.h"
#include "libperception/simulation/weather/Beam.h"
#include "libperception/simulation/world/World.h"

namespace perception {
namespace {

// method.md 9.9, assumed.
constexpr double kCloudyThreshold = 1.15, kSunnyThreshold = 1.5, kNoise = 2e-5;
constexpr double kNoiseIntensity = 0.1;                          // at most
constexpr double kNightRecall = 0.5, kLit = 15;                  // [m] of the own headlights
constexpr double kGlareRecall = 0.7, kGlareWidth = radians(20);  // to each side
constexpr double kLowSun = radians(20);                          // elevation
constexpr double kBeamWidth = radians(30), kHeadlightsTo = 60;   // to each side; [m]
constexpr double kCloudyAmbient = 0.4;                           // least share under clouds
// Images at night, in units of 100 klx of the sun: lit streets of 10 lx (EN 13201-2, P2); low beams
// of 20,000 cd; 30 ms and gain 20 where day has 2 ms (assumed).
constexpr double kNightAmbient = 1e-4, kHeadlights = 0.2, kNightTime = 0.030, kNightGain = 20;
constexpr std::size_t kTheSun = std::numeric_limits<std::size_t>::max();

bool hasHeadlights(const ObjectParams& object) {
  const bool vehicle = object.kind == ObjectKind::kCar || object.kind == ObjectKind::kVan ||
                       object.kind == ObjectKind::kBus;
  return vehicle && object.waypoints.t.size() > 1;  // parked ones are dark
}

}  // namespace

Daylight::Daylight(Sky sky, const Lighting& light)
    : sky_(sky),
      low_sun_(light.hasSun() && light.sun_elevation < kLowSun),
      sun_azimuth_(light.sun_azimuth) {}

// The sun's mirror in a wet road is below the sun: in the same azimuth.
void Daylight::advance(const World& world, const SensorParams& sensor, double t) {
  glare_.clear();
  if (!sensor.isCamera()) return;
  heading_ = yawOf(world.ego(t).T_world_ego);
  if (sky_ == Sky::kSunny && low_sun_) glare_.push_back({sun_azimuth_, kTheSun});
  if (sky_ != Sky::kNight) return;
  const Vector2 eye = (world.ego(t).T_world_ego * sensor.T_ego_sensor()).translation().head<2>();
  for (std::size_t i = 0; i < world.objects(); ++i) {
    if (!hasHeadlights(world.scenario().objects[i]) || !world.present(i, t)) continue;
    const Pose3 pose = world.object(i, t).T_world_object;
    const Vector2 arm = pose.translation().head<2>() - eye;
    const double azimuth = std::atan2(arm.y(), arm.x());
    const bool oncoming = std::abs(wrapAngle(azimuth + kPi - yawOf(pose))) < kBeamWidth;
    if (oncoming && arm.norm() < kHeadlightsTo) glare_.push_back({azimuth, i});
  }
}

void Daylight::alter(const SensorParams& sensor, LidarPulse& pulse, Rng& rng) const {
  pulse.threshold *= sky_ == Sky::kSunny ? kSunnyThreshold : kCloudyThreshold;
  if (sky_ != Sky::kSunny || rng.uniform() >= kNoise) return;
  LidarPulse::Scatterer noise;
  noise.range = rng.uniform(0, sensor.lidar.range_max);
  noise.intensity = rng.uniform(0, kNoiseIntensity);
  noise.phantom = Phantom::kNoise;
  if (noise.range < openRange(pulse)) pulse.scatterers.push_back(noise);
}

void Daylight::alter(const SensorParams&, CameraLook& look, Rng&) const {
  if (sky_ == Sky::kNight && look.range > kLit) look.chance *= kNightRecall;
  for (const Glare& glare : glare_) {
    if (glare.source == look.object ||
        std::abs(wrapAngle(look.azimuth - glare.azimuth)) > kGlareWidth)
      continue;
    look.chance *= kGlareRecall;
    return;
  }
}

void Daylight::alter(const SensorParams&, Lighting& light, Rng&) const {
  if (sky_ == Sky::kSunny) return;
  light.sun_elevation = std::min(light.sun_elevation, radians(-1));
  light.ambient = sky_ == Sky::kNight ? kNightAmbient : std::max(light.ambient, kCloudyAmbient);
  if (sky_ != Sky::kNight) return;
  light.exposure *= kNightGain * kNightTime / light.exposure_time;
  light.exposure_time = kNightTime, light.gain = kNightGain;
  light.headlights = kHeadlights, light.headlights_azimuth = heading_;
}

void Daylight::alter(const SensorParams&, CameraView& view, Rng& rng) const {
  addSensorNoise(view, rng);
}

}  // namespace perception
