#pragma once
#include <functional>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/math/Random.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/simulation/SimulatedWeather.h"
#include "libperception/simulation/lidar/LidarSensorParams.h"

namespace perception {

class LidarCaster;

/// Effect of weather on a pulse; empty: clear air.
using PulseHook = std::function<void(LidarPulse&, Rng&)>;

/// Converts ray hits to returns by the lidar equation, method.md (57), in clear air.
class LidarSensor {
 public:
  LidarSensor(const LidarSensorParams& params, double rate);  ///< rate [1/s]

  /// One scan and the number of returns on each object of the scenario.
  struct Scan {
    LidarCloud cloud;
    std::vector<int> points_on;
    std::vector<int> surfaces;      ///< of each return: as BeamHit::object, of the beam's surface
    std::vector<Phantom> phantoms;  ///< of each return; empty in clear air
  };
  using PoseAt = std::function<Pose3(double t)>;  ///< T_world_sensor at t [s]
  /// The scan that starts at t [s]; changes the caster's time if sweeping.
  Scan scan(LidarCaster& caster, double t, const PoseAt& T_world_sensor, const RngKey& key,
            const PulseHook& hook = {}) const;
  std::size_t beams() const;  ///< of one scan

 private:
  /// One direction of the pattern.
  struct Beam {
    Vector3 direction;          // sensor frame
    double azimuth, elevation;  // [rad] of the direction
    std::uint16_t ring;
    std::uint32_t slot;  // of its random numbers
  };
  std::vector<LidarPulse> pulsesOf(const LidarCaster& caster, std::size_t slice, const Pose3& pose,
                                   const std::vector<Vector3>& directions) const;

  LidarSensorParams params_;
  std::vector<std::vector<Beam>> slices_;  // by time; one when not sweeping
  double slice_time_ = 0;                  // [s]
};

}  // namespace perception
