#pragma once
#include <functional>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Frames.h"
#include "libperception/core/Random.h"
#include "libperception/measurement/SensorFrame.h"
#include "libperception/simulation/SimulatedWeather.h"

namespace perception {

class LidarCaster;

/// An automotive radar that hands over a list of targets, in a [sensor.LABEL] section. View after
/// the Delphi units of Cornell's 2007 vehicle (15 deg: [cornell2007]), noise of a modern unit
/// (method.md 4.3); the rest is assumed.
struct RadarUnitParams {
  double fov = radians(15);               ///< [rad] whole width of the view
  double range_min = 1, range_max = 150;  ///< [m]
  double reference_range = 150;           ///< [m] a car is resolved in every second scan there
  double false_alarm = 1e-6;              ///< P_fa of one cell, sets the threshold (method.md 9.8)
  double range_noise = 0.5;               ///< [m]
  double bearing_noise = radians(2);      ///< [rad]
  double rate_noise = 0.15;               ///< [m/s]
  double person = 0.05, cyclist = 0.3, vehicle = 0.9;  ///< P_D near by (method.md 2.3)
  double surroundings = 0.3;  ///< the same of poles, walls and bushes (method.md 2.3: static-other)
  double ground_per_scan = 0.1;  ///< echoes of the road itself, curbs, manhole covers
  double false_per_scan = 0.02;  ///< targets that are nothing ("few false positives" [radecki2016])
  double double_bounce = 0.01;   ///< share of near returns that come again at twice the range
  int max_targets = 20;          ///< the unit tracks no more
  bool upside_down = false;  ///< mounted so, and its pose does not say it: bearings are mirrored

  void visit(ParamVisitor& v);
};

/// Where the unit is and how it moves.
struct RadarMount {
  Pose3 T_world_sensor = Pose3::Identity();
  Vector2 velocity = Vector2::Zero();  ///< [m/s] of the unit, world: lever arm included
};

/// The unit's cell (method.md 9.9): closer reflections are one target.
struct RadarCell {
  static constexpr double kRange = 0.75;          ///< [m]
  static constexpr double kBearing = radians(4);  ///< [rad]
  static constexpr double kRate = 0.5;            ///< [m/s]
};

/// Changes what the unit receives; empty: clear air.
using RadarHook = std::function<void(RadarReflection&, Rng&)>;

/// Scattering centers of all objects in the unit's view at t [s], with their mean power; `caster`
/// stands at t. Vehicles: corners and sides that face the unit, the nearest strongest.
std::vector<RadarReflection> radarReflections(const LidarCaster& caster, double t,
                                              const RadarUnitParams& params,
                                              const RadarMount& mount);

/// The unit's list of targets at t [s], by range.
RadarReturns radarReturns(const LidarCaster& caster, double t, const RadarUnitParams& params,
                          const RadarMount& mount, const RngKey& key, const RadarHook& hook = {});

}  // namespace perception
