#include "libperception/simulation/weather/sensors/Fouling.h"

#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/simulation/world/World.h"

namespace perception {
namespace {

constexpr double kPatch = radians(2), kLensPatch = radians(10);  // assumed
constexpr double kBlurredRecall = 0.5;                           // assumed
constexpr std::uint32_t kDirt = 0x57EA2000;                      // purpose of random numbers

}  // namespace

Fouling::Fouling(double share, double radome_db, std::uint64_t seed)
    : share_(share), radome_(std::pow(10, -.1 * 2 * radome_db)), seed_(seed), grid_(kPatch) {}

// Dirt stays where it is.
void Fouling::advance(const World& world, const SensorParams& sensor, double t) {
  if (share_ <= 0 || (!sensor.isCamera() && !sensor.isLidar())) return;
  yaw_ = yawOf(world.ego(t).T_world_ego * sensor.T_ego_sensor());
  grid_ = AimGrid(sensor.isLidar() ? kPatch : kLensPatch);
  dirty_.resize(grid_.cells());
  Rng rng({seed_, 0, 0, streamOf(sensor.label, kDirt)});
  for (char& cell : dirty_) cell = rng.uniform() < share_;
}

void Fouling::alter(const SensorParams&, LidarPulse& pulse, Rng&) const {
  if (dirty_[grid_.at(pulse.azimuth, pulse.elevation).cell]) pulse.blocked = true;
}

void Fouling::alter(const SensorParams&, RadarReflection& reflection, Rng&) const {
  reflection.snr *= radome_;
}

void Fouling::alter(const SensorParams&, RadarAir& air, Rng&) const { air.passing *= radome_; }

void Fouling::alter(const SensorParams&, CameraLook& look, Rng&) const {
  if (share_ <= 0) return;
  if (dirty_[grid_.at(wrapAngle(look.azimuth - yaw_), 0).cell]) look.chance *= kBlurredRecall;
}

}  // namespace perception
