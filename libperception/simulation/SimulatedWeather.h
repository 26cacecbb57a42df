#pragma once
#include <cstdint>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/math/Random.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/world/Lighting.h"

namespace perception {

class World;
struct SensorParams;
struct CameraView;

/// The cause of a lidar return that does not come from a surface.
enum class Phantom : std::uint8_t {
  kNone,
  kRain,
  kSnow,
  kFog,
  kSpray,
  kPlume,
  kMirror,
  kNoise,
  kDirt
};

/// A lidar pulse and its targets, before detection.
struct LidarPulse {
  /// A backscattering particle or cloud: a raindrop, a snowflake, a plume.
  struct Scatterer {
    double range = 0;  ///< [m]
    double power = 0;  ///< in the unit of the lidar equation: reflectivity / range^2
    /// [0, 1] where a law of measured returns gives it: the nearest such return is received,
    /// whatever the other echoes and the power. < 0: the power decides.
    double intensity = -1;
    Phantom phantom = Phantom::kNone;
  };
  Vector3 origin, direction;           ///< [m], unit vector; world
  double azimuth = 0, elevation = 0;   ///< [rad] the direction in the sensor's frame
  const LidarCaster* scene = nullptr;  ///< for paths over mirrors
  BeamHit hit;                         ///< the surface
  double reflectivity = 0;             ///< of the surface towards the sensor, incidence included
  double lost = 0;                     ///< share of pulses without backscatter: glass, mirrors
  double optical_depth = 0;  ///< one way to the surface: attenuates the echo by exp(-2 depth)
  double threshold = 1;      ///< factor on the detection threshold (P_min of method.md (57))
  bool blocked = false;      ///< nothing comes back: dirt on the window
  std::vector<Scatterer> scatterers;  ///< the strongest echo of a pulse is received
};

/// One radar scattering center, before resolution cells are formed.
struct RadarReflection {
  int object = -1;        ///< index in the scenario; -1: ground
  Vector2 position;       ///< [m] world
  double range = 0;       ///< [m]
  double bearing = 0;     ///< [rad] off the unit's axis, to the left
  double range_rate = 0;  ///< [m/s] > 0: receding
  double snr = 0;         ///< mean ratio of signal to noise (power)
};

/// The air before a radar and its radome, where no object is.
struct RadarAir {
  double backscatter = 0;  ///< [1/m] radar cross section of a unit of volume
  double passing = 1;      ///< share of the power that the radome lets through, both ways
};

/// One object in the view of an image detector.
struct CameraLook {
  std::size_t object = 0;
  double range = 0;       ///< [m]
  double azimuth = 0;     ///< [rad] world, of the line of sight
  double chance = 0;      ///< [0, 1] P_D
  double edge_noise = 0;  ///< of a box edge, as a share of the box's height
  /// Of the air up to the object: with the contrast the chance falls (contrastRecall()).
  double optical_depth = 0;
};

/// Weather between sensors and objects: may modify every pulse, reflection, look, image and the
/// light of images before detection. This base class is clear air and changes nothing; derived
/// classes override what they affect. alter() is const, so that a frame may be simulated in
/// parallel; randomness comes only from `rng`, a separate stream.
class SimulatedWeather {
 public:
  virtual ~SimulatedWeather() = default;
  /// Called before each observation of a sensor in chronological order; t [s]. For what moves
  /// (spray, plumes) and what is the same for many beams.
  virtual void advance(const World&, const SensorParams&, double /*t*/) {}
  virtual void alter(const SensorParams&, LidarPulse&, Rng&) const {}
  virtual void alter(const SensorParams&, RadarReflection&, Rng&) const {}
  virtual void alter(const SensorParams&, RadarAir&, Rng&) const {}
  virtual void alter(const SensorParams&, CameraLook&, Rng&) const {}
  /// Light and air of one rendered image: fog, night, a low sun.
  virtual void alter(const SensorParams&, Lighting&, Rng&) const {}
  /// An image, rendered or recorded, in the light and air that alter(Lighting) set: what falls
  /// through it, drops on the lens, the sensor's noise.
  virtual void alter(const SensorParams&, CameraView&, Rng&) const {}
  /// The whole frame: false boxes of mirror images, noise returns, fouling.
  virtual void alter(const SensorParams&, SensorFrame&, Rng&) const {}
  /// False: alter() does not change pulses and is not called for them.
  virtual bool actsOnPulses() const { return false; }
};

}  // namespace perception
