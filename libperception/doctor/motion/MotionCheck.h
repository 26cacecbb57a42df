#pragma once
#include <optional>
#include <vector>

#include "libperception/doctor/motion/ImageMotion.h"
#include "libperception/doctor/motion/RadarVelocity.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Errors of a sensor's mounting and clock in the log, from its own motion compared with the poses:
/// the log's value minus the true one (method.md 8.13).
struct MotionCheck {
  struct Value {
    double error = 0, sigma = 0;
    double enough = 0;  ///< largest standard deviation with which the error counts as observed
    double wrong = 0;   ///< errors up to this do not matter
    bool observable() const { return sigma <= enough; }
    bool isWrong() const;  ///< observable, and larger than its uncertainty and `wrong`
  };
  Value yaw, pitch, roll;  ///< [rad]
  Value ahead, left;       ///< [m] place in the vehicle
  Value clock;             ///< [s] stamps are late by this
  std::size_t used = 0;    ///< scans
};

/// `scans`: poses of the vehicle by odometry from the lidar under the log's mounting. `poses`: the
/// log's, in any order. Empty without enough of both at the same time, or if the vehicle stands.
std::optional<MotionCheck> checkLidarMotion(const std::vector<EgoState>& scans,
                                            const Pose3& T_ego_sensor,
                                            const std::vector<EgoState>& poses);
std::optional<MotionCheck> checkRadarMotion(const std::vector<SensorVelocity>& scans,
                                            const Pose3& T_ego_sensor,
                                            const std::vector<EgoState>& poses);

/// Of a camera: it shows its turn and the clock; its place is left as not observable.
std::optional<MotionCheck> checkImageMotion(const std::vector<CameraMotion>& motions,
                                            const Pose3& T_ego_sensor,
                                            const std::vector<EgoState>& poses);

/// A position of a GNSS antenna.
struct AntennaPlace {
  Stamp stamp;
  Vector2 place = Vector2::Zero();  ///< [m] east, north
};
/// Clock and antenna (`ahead`, `left`; `antenna` is the log's, vehicle frame) of a receiver against
/// the poses, whose world may be turned to east and north by any angle. The other values are not
/// observable.
std::optional<MotionCheck> checkGnssMotion(const std::vector<AntennaPlace>& fixes,
                                           const Vector2& antenna,
                                           const std::vector<EgoState>& poses);

/// The log's mounting without the errors that were observed and are wrong.
Pose3 correctedMounting(const MotionCheck& check, const Pose3& T_ego_sensor);

}  // namespace perception
