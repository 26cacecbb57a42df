#pragma once
#include <functional>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Frames.h"
#include "libperception/core/Random.h"
#include "libperception/measurement/SensorFrame.h"
#include "libperception/simulation/SimulatedWeather.h"

namespace perception {

class LidarCaster;

/// A scanning lidar in a [sensor.LABEL] section. Defaults: HDL-64E (data sheet, KITTI's pattern),
/// loss and label errors assumed.
struct LidarParams {
  enum class Layout { kHdl64, kFourLayer };
  Layout layout = Layout::kHdl64;  ///< elevations of the beams; from the sensor's kind
  double azimuth_from = -kPi,
         azimuth_to = kPi;              ///< [rad] of the sensor's forward axis, to the left
  double azimuth_step = radians(0.18);  ///< [rad] 0.16 to 0.2 deg at 10 turns a second
  double elevation_from = -kPi / 2, elevation_to = kPi / 2;  ///< [rad] rings beyond are left out
  int ring_step = 1;       ///< keeps every n-th ring, to thin a log
  double range_min = 0.9;  ///< [m]
  double range_max = 120;  ///< [m]
  double reference_range =
      200;                    ///< [m] R_max of method.md (50): a surface of 90 % is just seen there
  double range_noise = 0.01;  ///< [m] at the strongest echo
  double loss = 0.003;        ///< share of pulses that are lost whatever they meet
  /// [rad] whole width of the beam (method.md 9: 3 mrad). A beam on an edge returns the stronger of
  /// the two surfaces, or their mean when they lie within one pulse. 0: a ray without width.
  double divergence = 0;
  double label_error = 0;  ///< share of wrong point labels (four layers: object, ground)
  bool sweep = false;      ///< beams at their own times while everything moves

  /// Ibeo ALASCA XT: four layers 0.8 deg apart, 0.25 deg in azimuth, own labels.
  static LidarParams fourLayer();
  void visit(ParamVisitor& v);
  /// Elevations [rad] of the rings, lowest first.
  std::vector<double> elevations() const;
};

/// Changes what a pulse meets; empty: clear air.
using PulseHook = std::function<void(LidarPulse&, Rng&)>;

/// Turns beams' hits into returns: the common lidar equation of method.md (50), in clear air.
class LidarSensor {
 public:
  LidarSensor(const LidarParams& params, double rate);  ///< rate [1/s]

  /// One scan and the number of returns on each object of the scenario.
  struct Scan {
    LidarCloud cloud;
    std::vector<int> points_on;
  };
  using PoseAt = std::function<Pose3(double t)>;  ///< T_world_sensor at t [s]
  /// The scan that starts at t; leaves the caster at another time when sweeping.
  Scan scan(LidarCaster& caster, double t, const PoseAt& T_world_sensor, const RngKey& key,
            const PulseHook& hook = {}) const;
  std::size_t beams() const;  ///< of one scan

 private:
  struct Beam {
    Vector3 direction;  // sensor frame
    std::uint16_t ring;
    std::uint32_t slot;  // of its random numbers
  };
  std::vector<LidarPulse> pulsesOf(const LidarCaster& caster, std::size_t slice, const Pose3& pose,
                                   const std::vector<Vector3>& directions) const;

  LidarParams params_;
  std::vector<std::vector<Beam>> slices_;  // by time; one when not sweeping
  double slice_time_ = 0;                  // [s]
};

}  // namespace perception
