#pragma once
#include <vector>

#include "libperception/simulation/SimulatedWeather.h"
#include "libperception/simulation/cameras/CameraView.h"
#include "libperception/simulation/lidar/LidarCaster.h"

namespace perception {

/// The light of a recorded image (method.md 9.14): no sun, since its place is not known, no haze,
/// and an ambient light in which a white surface would be as bright as the horizon.
Lighting recordedLight(const std::vector<Eigen::Vector3f>& linear);

/// A recorded image in the weather. `view`: camera, pose and velocity; its light, values and ranges
/// are set here, the ranges from `returns` [m, world]. `caster`: its threads. Gray images stay
/// gray.
Raster throughWeather(const Raster& image, CameraView view, const std::vector<Vector3>& returns,
                      const SimulatedWeather& weather, const SensorParams& sensor,
                      const LidarCaster& caster, const RngKey& key);

}  // namespace perception
