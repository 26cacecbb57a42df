#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/core/Time.h"

namespace perception {

/// Horizontal position of a GNSS antenna in meters east and north of a common origin.
struct PlaceFix {
  Stamp stamp;
  Vector2 place = Vector2::Zero();
  double sigma = 1.5;  ///< [m] each axis
};

/// A pose of the own vehicle in the log's world frame, with the log's frame number (-1: none).
struct FramePose {
  Stamp stamp;
  std::int64_t frame = -1;
  Pose3 T_world_ego = Pose3::Identity();
};

/// East and north to the log's world frame: world = R(yaw) place + shift.
struct WorldAlignment {
  double yaw = 0;  ///< [rad]
  Vector2 shift = Vector2::Zero();
  double rms = 0;        ///< [m] of the own fixes about the own way
  double sigma_yaw = 0;  ///< [rad] by their scatter
  std::size_t used = 0;  ///< fixes
};
/// Least squares of the own vehicle's fixes and the places of its antenna (vehicle frame, [m]) by
/// its poses. Throws DataError with less than three fixes or a way too short to show a direction.
WorldAlignment alignToWorld(const std::vector<PlaceFix>& fixes, const Vector2& antenna,
                            const std::vector<FramePose>& poses);

/// The other vehicle, as its truth names it.
struct OtherVehicle {
  std::int64_t id = 1;
  std::string type = "Car";
  double length = 4.5, width = 1.8, height = 1.5;  ///< [m]
  Vector2 antenna = Vector2::Zero();  ///< [m] ahead and to the left of the footprint's center
};
/// Its place, heading and velocity at the instants of the own poses, smoothed from its fixes with
/// nearly constant velocity (method.md 11.2); none where no fix is within 2 s on both sides.
/// `first`: the log's first stamp.
std::vector<TruthObject> truthOfVehicle(const std::vector<PlaceFix>& fixes,
                                        const WorldAlignment& alignment,
                                        const OtherVehicle& vehicle,
                                        const std::vector<FramePose>& poses, Stamp first);

}  // namespace perception
