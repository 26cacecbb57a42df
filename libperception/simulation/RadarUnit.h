#pragma once
#include <functional>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Frames.h"
#include "libperception/core/math/Random.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/simulation/SimulatedWeather.h"

namespace perception {

class LidarCaster;

/// An automotive radar that outputs a list of targets: [sensor.LABEL] kind = radar. Field of view
/// of the Delphi units of Cornell's 2007 vehicle (15 deg: [cornell2007]), noise of a modern unit
/// (method.md 4.3); the rest is assumed.
struct RadarUnitParams {
  double fov = radians(15);               ///< [rad] full horizontal field of view
  double range_min = 1, range_max = 150;  ///< [m]
  double reference_range = 150;           ///< [m] range at which P_D of a car is .5
  double false_alarm = 1e-6;              ///< P_fa of one cell, sets the threshold (method.md 9.8)
  double range_noise = 0.5;               ///< [m]
  double bearing_noise = radians(2);      ///< [rad]
  double rate_noise = 0.15;               ///< [m/s]
  double person = 0.05, cyclist = 0.3, vehicle = 0.9;  ///< P_D near by (method.md 2.3)
  double surroundings = 0.3;     ///< P_D of poles, walls and bushes (method.md 2.3: static-other)
  double ground_per_scan = 0.1;  ///< mean number of echoes of road, curbs, manhole covers
  double false_per_scan =
      0.02;  ///< mean number of false targets ("few false positives" [radecki2016])
  double double_bounce = 0.01;  ///< share of near returns with a second one at twice the range
  int max_targets = 20;         ///< limit of the unit's target list
  bool upside_down =
      false;  ///< mounted upside down, not modeled by its pose: bearings are mirrored

  void visit(ParamVisitor& v);
};

/// Pose and velocity of the unit.
struct RadarMount {
  Pose3 T_world_sensor = Pose3::Identity();
  Vector2 velocity = Vector2::Zero();  ///< [m/s] of the unit, world: lever arm included
};

/// Resolution cell (method.md 9.9): reflections within one cell are one target.
struct RadarCell {
  static constexpr double kRange = 0.75;          ///< [m]
  static constexpr double kBearing = radians(4);  ///< [rad]
  static constexpr double kRate = 0.5;            ///< [m/s]
};

/// Effect of weather on a reflection; empty: clear air.
using RadarHook = std::function<void(RadarReflection&, Rng&)>;

/// Cross section of a car, the reference of RadarUnitParams::reference_range.
inline constexpr double kCarSection = 10;  ///< [m^2]

/// Mean ratio of signal to noise of a car at `range` [m] (method.md 9.8).
double carSnr(double range, const RadarUnitParams& params);

/// Scattering centers of all objects in the unit's view at t [s], with their mean power; `caster`
/// must be set to t. Vehicles: corners and sides that face the unit, the nearest strongest.
std::vector<RadarReflection> radarReflections(const LidarCaster& caster, double t,
                                              const RadarUnitParams& params,
                                              const RadarMount& mount);

/// The unit's list of targets at t [s], by range.
RadarReturns radarReturns(const LidarCaster& caster, double t, const RadarUnitParams& params,
                          const RadarMount& mount, const RngKey& key, const RadarHook& hook = {},
                          const RadarAir& air = {});

}  // namespace perception
