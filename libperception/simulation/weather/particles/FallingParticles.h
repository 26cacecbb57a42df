#pragma once
#include <functional>

#include "libperception/simulation/cameras/CameraView.h"
#include "libperception/simulation/weather/particles/Precipitation.h"

namespace perception {

/// Drops or flakes in the air as a camera sees them.
struct FallingParticles {
  SizeDistribution sizes;                             ///< of their diameters
  std::function<double(double diameter)> fall_speed;  ///< [m/s] of a diameter [mm]
  std::function<Rgb(const Vector3& direction, double range)> radiance;  ///< of one, world; [m]
};

/// Draws single particles between the camera and its surfaces: as many, as large and as fast as
/// they are (method.md 9.14). Each covers pi/4 (f D / z)^2 square pixels for the shutter's time,
/// spread over its way in the image and the lens's blur. Fainter ones than kFaintest are left out:
/// they are in the haze. Returns the number of particles drawn.
std::size_t drawParticles(const FallingParticles& particles, CameraView& view, Rng& rng);

/// Share of a pixel's light from which on a particle is drawn.
inline constexpr double kFaintest = 1.0 / 100;

}  // namespace perception
