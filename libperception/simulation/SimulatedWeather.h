#pragma once
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/Random.h"
#include "libperception/measurement/SensorFrame.h"
#include "libperception/simulation/LidarCaster.h"
#include "libperception/simulation/Lighting.h"

namespace perception {

class World;
struct SensorParams;

/// A lidar pulse and what it meets, before the instrument decides whether it received an echo.
struct LidarPulse {
  /// Something in the air that sends light back: a drop, a flake, a plume.
  struct Scatterer {
    double range = 0;  ///< [m]
    double power = 0;  ///< in the unit of the lidar equation: reflectivity / range^2
  };
  Vector3 origin, direction;  ///< [m], unit vector; world
  BeamHit hit;                ///< the surface
  double reflectivity = 0;    ///< of the surface towards the sensor, incidence included
  double lost = 0;            ///< share of pulses that send nothing back: glass, mirrors
  double optical_depth = 0;   ///< one way to the surface: it weakens the echo by exp(-2 depth)
  double threshold = 1;       ///< times the instrument's weakest echo (P_min of method.md (50))
  std::vector<Scatterer> scatterers;  ///< the strongest echo of a pulse is received
};

/// One scattering center as a radar sees it, before cells are formed.
struct RadarReflection {
  int object = -1;        ///< of the scenario; -1: the ground
  Vector2 position;       ///< [m] world
  double range = 0;       ///< [m]
  double bearing = 0;     ///< [rad] off the unit's axis, to the left
  double range_rate = 0;  ///< [m/s] > 0 moves away
  double snr = 0;         ///< mean ratio of signal to noise (power)
};

/// One object before a detector that looks for boxes.
struct CameraLook {
  std::size_t object = 0;
  double range = 0;       ///< [m]
  double azimuth = 0;     ///< [rad] world, of the line of sight
  double chance = 0;      ///< [0, 1] probability that it is found
  double edge_noise = 0;  ///< of a box edge, as a share of the box's height
};

/// What lies between the sensors and the things: the simulator shows it every pulse, reflection,
/// look and the light of every image, and it may change them. This class is clear air and changes
/// nothing; a kind of weather overrides what it acts on. Const while a frame is sensed, so frames
/// may be sensed in parallel; randomness comes from `rng` alone, a stream of its own.
class SimulatedWeather {
 public:
  virtual ~SimulatedWeather() = default;
  /// Before each observation, in order of time; t [s]. For what moves by itself: spray, plumes.
  virtual void advance(const World&, double /*t*/) {}
  virtual void alter(const SensorParams&, LidarPulse&, Rng&) const {}
  virtual void alter(const SensorParams&, RadarReflection&, Rng&) const {}
  virtual void alter(const SensorParams&, CameraLook&, Rng&) const {}
  /// Light and air of one rendered image: fog, night, a low sun.
  virtual void alter(const SensorParams&, Lighting&, Rng&) const {}
  /// The whole frame: false boxes of mirror images, noise returns, fouling.
  virtual void alter(const SensorParams&, SensorFrame&, Rng&) const {}
  /// False: alter() of pulses is the identity and need not be called.
  virtual bool actsOnPulses() const { return false; }
};

}  // namespace perception
