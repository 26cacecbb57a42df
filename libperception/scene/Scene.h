#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/Kinematics.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/measurement/objects/ObjectClass.h"

namespace perception {

/// From this probability on the front of an object counts as known.
inline constexpr double kSureFront = 0.9;

/// One tracked and classified object of the output. World frame, SI units.
struct SceneObject {
  std::uint64_t id = 0;     ///< 1, 2, 3 ... in order of first output; stays with the object
  ClassId class_id = 0;     ///< most probable class
  bool classified = false;  ///< its probability is at least .95
  std::vector<double> class_probability;  ///< in the order of the class table; sums to 1
  double existence = 0;                   ///< probability that the track is a real object
  Vector3 position = Vector3::Zero();     ///< [m] center of the footprint, z = base of the object
  double yaw = 0;                         ///< [rad] direction of the length axis, front first
  /// Probability that yaw points to the front and not to the back; .5: only the axis is known.
  double p_front = 0.5;
  bool has_yaw = false;                      ///< false: yaw is the direction of motion or 0
  Vector2 velocity = Vector2::Zero();        ///< [m/s]
  double speed = 0;                          ///< [m/s] along yaw; negative: reversing
  double length = 0, width = 0, height = 0;  ///< [m]
  double sd_x = 0, sd_y = 0, sd_yaw = 0, sd_speed = 0;  ///< [m, m, rad, m/s] standard deviations
  /// Of (x, y, vx, vy) in [m, m/s], world frame: the spread between the classes is part of it.
  Matrix4 covariance = Matrix4::Zero();
  std::map<Modality, Stamp> last_hit;  ///< last measurement of each modality
};

/// What the safety grid says about the arc that the vehicle drives, forward or backward.
struct FreePath {
  double distance = 0;      ///< [m] from the ego origin, seen and free
  double seen = 0;          ///< [m] to which the path was observed
  bool blocked = false;     ///< an occupied cell was found
  bool stop = false;        ///< it is nearer than the vehicle can stop
  double safe_speed = 0;    ///< [m/s] from which the vehicle stops within what is seen and free
  bool too_fast = false;    ///< it drives faster than that
  std::uint64_t owner = 0;  ///< id of the object that covers the cell; 0: none
  /// What shows the obstacle: occupied cells, the returns of one scan, or a track that covers
  /// either of these. It has no meaning if the path is free.
  enum class Cause : std::uint8_t { kGrid, kReturns, kObject };
  Cause cause = Cause::kGrid;
  std::uint32_t returns = 0;    ///< that count for it, of a scan or of half a second
  std::uint32_t overruled = 0;  ///< of these: doubted, but without a cause here
};

/// The objects around the vehicle at one instant: the output of a run.
struct Scene {
  Stamp stamp;
  std::int64_t frame = -1;  ///< the log's frame number; -1 = none
  EgoState ego;
  std::vector<SceneObject> objects;  ///< by id
  std::optional<FreePath> path;      ///< empty: no grid, or no lidar scan lately
};

}  // namespace perception
