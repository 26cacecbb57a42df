#pragma once
#include <vector>

#include "libperception/simulation/lidar/LidarSensorParams.h"
#include "libperception/simulation/recorded/BeamPattern.h"
#include "libperception/simulation/world/Scenario.h"

namespace perception {

class LidarCaster;

/// What a recorded lidar would have returned through weather.
struct WeatheredScan {
  LidarCloud cloud;
  std::vector<Phantom> phantoms;  ///< of each return
  std::uint64_t lost = 0;         ///< returns of the recording that are gone
};

/// Runs a recorded scan through `weather`. Every return is a pulse that has met a surface whose
/// reflectivity is its intensity (0.2 in a cloud without intensities), but at least once to twice
/// what a return from there takes; the road are the returns near the lowest ones around them.
/// Pulses without a return are `missing`. Returns that the weather leaves stay where they were, to
/// the last bit. `scene`: at the time of the scan, for mirrors; `T_world_sensor` on its flat road.
WeatheredScan throughWeather(const LidarCloud& cloud, const std::vector<BeamPattern::Beam>& missing,
                             const SimulatedWeather& weather, const SensorParams& sensor,
                             const Pose3& T_world_sensor, const LidarCaster& scene,
                             const RngKey& key);

}  // namespace perception
