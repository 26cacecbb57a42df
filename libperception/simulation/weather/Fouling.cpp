#include "libperception/simulation/weather/Fouling.h"

#include <cmath>

#include "libperception/core/Angle.h"
#include "libperception/simulation/World.h"
#include "libperception/simulation/weather/Beam.h"

namespace perception {
namespace {

constexpr double kPatch = radians(2), kLensPatch = radians(10);  // assumed
constexpr double kBlurredRecall = 0.5;                           // assumed
constexpr std::uint32_t kDirt = 0x57EA2000;                      // purpose of random numbers

}  // namespace

Fouling::Fouling(double share, double radome_db, std::uint64_t seed)
    : share_(share), radome_(std::pow(10, -.1 * 2 * radome_db)), seed_(seed) {}

void Fouling::advance(const World& world, const SensorParams& sensor, double t) {
  if (sensor.isCamera()) yaw_ = yawOf(world.ego(t).T_world_ego * sensor.T_ego_sensor());
}

// Dirt stays where it is.
bool Fouling::dirty(const SensorParams& sensor, std::uint32_t cell) const {
  return Rng({seed_, 0, cell, streamOf(sensor.label, kDirt)}).uniform() < share_;
}

void Fouling::alter(const SensorParams& sensor, LidarPulse& pulse, Rng&) const {
  if (dirty(sensor, aimCell(pulse.aim, kPatch).index)) pulse.blocked = true;
}

void Fouling::alter(const SensorParams&, RadarReflection& reflection, Rng&) const {
  reflection.snr *= radome_;
}

void Fouling::alter(const SensorParams& sensor, CameraLook& look, Rng&) const {
  const double aside = look.azimuth - yaw_;
  const AimCell cell = aimCell({std::cos(aside), std::sin(aside), 0}, kLensPatch);
  if (dirty(sensor, cell.index)) look.chance *= kBlurredRecall;
}

}  // namespace perception
