#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "libperception/config/Config.h"
#include "libperception/measurement/objects/MotionModel.h"

namespace perception {

using ClassId = int;  ///< index into ClassTable

/// What objects of a class look like to a sensor that classifies shapes: [class.NAME] shape.
enum class ObjectShape { kPedestrian, kCyclist, kVehicle, kThing, kPhantom };
inline constexpr std::size_t kObjectShapes = 5;

/// One kind of object: [class.NAME] of classes.ini. Defaults: method.md 2.2.
struct ObjectClass {
  std::string name;                                       ///< from the section's title
  const MotionModel* motion = findMotionModel("static");  ///< never null
  ObjectShape shape = ObjectShape::kThing;                ///< assumed of a class that tells none
  double accel_psd = 0.5;  ///< [m^2/s^3] white acceleration along the track (q_a or q_v)
  /// Interacting motion modes in place of `accel_psd` (method.md 3.6), one entry per mode; empty:
  /// one mode.
  std::vector<double> mode_accel_psd;  ///< [m^2/s^3]
  std::vector<double> mode_damping;    ///< [1/s] rate at which the speed decays; 0: constant speed
  std::vector<double> mode_sojourn;    ///< [s] mean time in the mode
  double yaw_rate_psd = 0.0685;        ///< [rad^2/s] wheeled only
  double lateral_psd = 0;              ///< [m^2/s^3] wheeled only: bounds yaw_rate_psd; 0: no bound
  double position_psd =
      1e-4;  ///< [m^2/s] slip and model mismatch; the only process noise of static objects
  double length = 1, width = 1, height = 1.5;  ///< [m] mean size
  double length_sigma = 1, width_sigma = 1,
         height_sigma = 1;  ///< [m] spread of the size over objects
  double prior = 0.2;       ///< share among newborn objects; normalized over the table
  double max_speed = 60;    ///< [m/s] largest plausible speed; bounds that of newborns
  bool reported =
      true;  ///< false: not a road user (static-other). Tracked and output as any object. KITTI
             ///< export: see KittiSelection::road_user_from; perception-calibrate tempering adds
             ///< its truth; perception-evaluate does not read it: EvaluationOptions::unnamed
  std::string kitti_type = "Misc";  ///< type written by the KITTI export

  /// [rad^2/s] White yaw rate at a speed [m/s]: what turns the vehicle pushes it sideways, and
  /// tires bound that (method.md 3.2).
  double yawRatePsd(double speed) const;
  std::size_t modes() const { return mode_accel_psd.size(); }  ///< 0: a single model
  void visit(ParamVisitor& v);
};

/// All classes of a run, in the order of classes.ini.
struct ClassTable {
  std::vector<ObjectClass> classes;

  int size() const { return static_cast<int>(classes.size()); }
  const ObjectClass& operator[](ClassId c) const { return classes[static_cast<std::size_t>(c)]; }
  /// The class of that name or -1.
  ClassId find(const std::string& name) const;
  std::vector<std::string> names() const;  ///< in their order
};

/// Reads every [class.NAME] of the configuration; reports to it when there is none. Priors are
/// normalized.
ClassTable readClassTable(Config& config);

}  // namespace perception
