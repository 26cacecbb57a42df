#pragma once
#include <vector>

#include "libperception/simulation/CameraView.h"
#include "libperception/simulation/LidarCaster.h"
#include "libperception/simulation/SimulatedWeather.h"

namespace perception {

/// What a recorded image tells of its light (method.md 9.14): no sun whose place is known, no haze,
/// and an ambient light so that the horizon is as bright as a white surface would be.
Lighting recordedLight(const std::vector<Eigen::Vector3f>& linear);

/// A recorded image in the weather. `view`: camera, pose and velocity; its light, values and ranges
/// are set here, the ranges from `returns` [m, world]. `caster`: its threads. Gray images stay
/// gray.
Raster throughWeather(const Raster& image, CameraView view, const std::vector<Vector3>& returns,
                      const SimulatedWeather& weather, const SensorParams& sensor,
                      const LidarCaster& caster, const RngKey& key);

}  // namespace perception
