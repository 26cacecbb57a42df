#pragma once
#include <mrpt/obs/CObservation.h>

#include <memory>
#include <optional>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/sensors/ego/EgoPose.h"
#include "libperception/sensors/satellites/GnssFix.h"

namespace perception {

/// Where a receiver is on WGS84, and what else is known of the vehicle then.
struct GeodeticPose {
  Stamp stamp;
  double latitude = 0, longitude = 0;  ///< [deg] of the antenna
  std::optional<double> height;        ///< [m] of the antenna above the ellipsoid
  std::optional<double> yaw;           ///< [rad] of the vehicle, counter-clockwise from east
  double pitch = 0, roll = 0;          ///< [rad] about y and x, as in Rz(yaw) Ry(pitch) Rx(roll)
  Vector3 antenna = Vector3::Zero();   ///< [m] in the vehicle frame
  PoseUncertainty uncertainty{0, 0, 0};

  /// Throws DataError where there is no such place on Earth or a number is not finite.
  void check() const;
};

/// Positions of a vehicle for a tracker. With a yaw they are poses in east, north, up about the
/// first one (or [ego] origin); without, fixes for EgoFusion, which finds the heading on the way.
class GeodeticPoses {
 public:
  explicit GeodeticPoses(const EgoPoseParams& params) : params_(params) {}
  /// A CObservationRobotPose or a CObservationGPS. Throws DataError, and Error (kUsage) for a fix
  /// that [ego] source leaves unread.
  std::shared_ptr<mrpt::obs::CObservation> observationOf(const GeodeticPose& pose);

 private:
  EgoState stateOf(const GeodeticPose& pose);

  EgoPoseParams params_;
  std::optional<LocalFrame> frame_;
  bool with_heights_ = false;
};

}  // namespace perception
