#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "libperception/simulation/SimulatedWeather.h"
#include "libperception/simulation/weather/particles/SnowFlakes.h"
#include "libperception/simulation/world/Scenario.h"
#include "libperception/simulation/world/World.h"
#include "tests/simulation/SceneText.h"

namespace perception::test {

/// A pulse of a sensor at 1.9 m height, `up` [rad] above the horizon, that meets nothing.
inline LidarPulse skyPulse(double azimuth, double up) {
  LidarPulse pulse;
  pulse.origin = {0, 0, 1.9};
  pulse.direction = {std::cos(up) * std::cos(azimuth), std::cos(up) * std::sin(azimuth),
                     std::sin(up)};
  pulse.azimuth = azimuth, pulse.elevation = up;
  return pulse;
}

/// A level pulse that meets a wall of 30 % at `range` [m].
inline LidarPulse wallPulse(double range) {
  LidarPulse pulse = skyPulse(0, 0);
  pulse.hit.range = static_cast<float>(range), pulse.hit.cos_incidence = 1;
  pulse.hit.object = 0, pulse.hit.material = Material::kWall;
  pulse.reflectivity = 0.3;
  return pulse;
}

/// Pulses to the sky of scans of 16 rings with 720 beams, by a lidar of a reference range [m];
/// calls see(ring, column, pulse).
inline void scanSky(SimulatedWeather& weather, int scans,
                    const std::function<void(int, int, const LidarPulse&)>& see,
                    double reference_range = LidarSensorParams().reference_range) {
  const World world(scenarioOf(kStanding + kRoofLidar));
  SensorParams sensor = world.scenario().sensors.front();
  sensor.lidar.reference_range = reference_range;
  for (int s = 0; s < scans; ++s) {
    weather.advance(world, sensor, 0.1 * s);
    for (int ring = 0; ring < 16; ++ring) {
      for (int i = 0; i < 720; ++i) {
        Rng rng({5, static_cast<std::uint64_t>(s), static_cast<std::uint32_t>(ring * 720 + i), 1});
        LidarPulse pulse = skyPulse(kTwoPi * i / 720 - kPi, radians(0.37 * ring));
        weather.alter(sensor, pulse, rng);
        see(ring, i, pulse);
      }
    }
  }
}

/// Mean of intensity times range [m] of the strongest echoes from 1.5 to 2.5 m.
inline double brightnessOf(SnowFlakes snow) {
  double sum = 0, count = 0;
  scanSky(snow, 8, [&](int, int, const LidarPulse& pulse) {
    const LidarPulse::Scatterer* strongest = nullptr;
    for (const auto& flake : pulse.scatterers)
      if (strongest == nullptr || flake.power > strongest->power) strongest = &flake;
    if (strongest == nullptr || strongest->range >= 2.5) return;
    ++count, sum += strongest->power * std::pow(strongest->range, 3);
  });
  return sum / count;
}

/// Largest difference between the empirical distribution of logs and a normal one, times sqrt(n);
/// above 1.63 for one in a hundred true samples (Kolmogorov-Smirnov).
inline double kolmogorovSmirnov(std::vector<double> ranges, double log_mean, double log_sigma) {
  std::sort(ranges.begin(), ranges.end());
  const double n = static_cast<double>(ranges.size());
  double most = 0;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double z = (std::log(ranges[i]) - log_mean) / log_sigma;
    const double law = .5 * std::erfc(-z / std::sqrt(2.0));
    most = std::max({most, std::abs(law - static_cast<double>(i) / n),
                     std::abs(law - static_cast<double>(i + 1) / n)});
  }
  return most * std::sqrt(n);
}

}  // namespace perception::test
