#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libperception/core/math/Random.h"
#include "libperception/measurement/models/PositionModel.h"
#include "libperception/measurement/objects/ObjectClass.h"

namespace perception {

/// Simulated encounters with position measurements, to study association separately: a vehicle at
/// rest at the origin, a field of view of 20 m to the front, a lidar at 10 Hz and a camera at 5 Hz
/// that measure (x, y) and a label.
struct EncounterScene {
  struct Object {
    bool car = false;           ///< else a pedestrian
    std::vector<Vector2> path;  ///< [m] at 10 Hz
  };
  std::vector<Object> objects;
  double step = 0.1;  ///< [s]
  std::size_t instants() const { return objects.empty() ? 0 : objects.front().path.size(); }
};

/// A walk of `duration` [s] from one place to another at a constant speed [m/s], with a random walk
/// of `jitter` [m/sqrt(s)] on top, at 10 Hz.
std::vector<Vector2> encounterWalk(const Vector2& from, const Vector2& to, double speed,
                                   double duration, double jitter, Rng& rng);

/// A busy street of 8 s: eight parked cars, six pedestrians, three passing cars.
EncounterScene busyStreet(Rng& rng);

/// Difficulty of a scene.
struct EncounterConditions {
  double detection_factor = 1;  ///< times P_D
  double clutter_factor = 1;    ///< times kappa
  double noise_factor = 1;      ///< times the sensors' covariances
  double merge_distance = 0;  ///< [m] objects of a class nearer than this merge with probability .8
};

/// Classes pedestrian and car; `pedestrian_psd` [m^2/s^3].
ClassTable encounterClasses(double pedestrian_psd = 0.25);
/// The two sensors; P_D, kappa and label tables after recall and precision of [radecki2016].
std::shared_ptr<const PositionModel> encounterLidar(const EncounterConditions& conditions);
std::shared_ptr<const PositionModel> encounterCamera(const EncounterConditions& conditions);

/// All scans of the scene in chronological order; scan.frame is the index of the instant.
std::vector<MeasurementScan> simulateEncounter(const EncounterScene& scene,
                                               const EncounterConditions& conditions, Rng& rng);

/// Whether an object at `p` is in the field of view.
inline bool encounterInView(const Vector2& p) { return p.x() > 0 && p.norm() < 20; }

}  // namespace perception
