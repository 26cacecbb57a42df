#include "libperception/python/arrays/GeodeticPose.h"

#include <fmt/format.h>
#include <mrpt/obs/CObservationGPS.h>

#include <cmath>

#include "libperception/core/Error.h"
#include "libperception/sensors/frames/ToObservation.h"
#include "libperception/sensors/observations/Conversions.h"

namespace perception {
namespace {

/// [m] standard deviation of a height that is not known.
constexpr double kAnyHeight = 1e4;
constexpr const char* kReceiver = "GNSS";

/// As a message of Novatel's, which has standard deviations.
std::shared_ptr<mrpt::obs::CObservation> fixOf(const GeodeticPose& pose, const GnssParams& params) {
  const double sigma = pose.uncertainty.sigma_xy > 0 ? pose.uncertainty.sigma_xy : params.sigma;
  mrpt::obs::gnss::Message_NV_OEM6_BESTPOS best;
  best.fields.solution_stat = mrpt::obs::gnss::nv_oem6_solution_status::SOL_COMPUTED;
  best.fields.lat = pose.latitude;
  best.fields.lon = pose.longitude;
  best.fields.hgt = pose.height.value_or(0);
  best.fields.undulation = 0;
  best.fields.lat_sigma = best.fields.lon_sigma = static_cast<float>(sigma);
  best.fields.hgt_sigma =
      static_cast<float>(pose.height ? params.height_factor * sigma : kAnyHeight);
  auto fix = std::make_shared<mrpt::obs::CObservationGPS>();
  fix->timestamp = fix->originalReceivedTimestamp = fromStamp(pose.stamp);
  fix->has_satellite_timestamp = true;
  fix->sensorLabel = kReceiver;
  fix->sensorPose = mrpt::poses::CPose3D(pose.antenna.x(), pose.antenna.y(), pose.antenna.z());
  fix->setMsg(best);
  return fix;
}

}  // namespace

void GeodeticPose::check() const {
  if (!std::isfinite(latitude) || std::abs(latitude) > 90)
    throw DataError(fmt::format("latitude: {}, expected -90 to 90 degrees", latitude));
  if (!std::isfinite(longitude) || std::abs(longitude) > 180)
    throw DataError(fmt::format("longitude: {}, expected -180 to 180 degrees", longitude));
  if (latitude == 0 && longitude == 0)
    throw DataError(
        "latitude 0 and longitude 0: what receivers send that have no position; leave it out");
  if (!std::isfinite(height.value_or(0))) throw DataError("height: not finite; None if not known");
  if (!std::isfinite(yaw.value_or(0) + pitch + roll) || !antenna.allFinite())
    throw DataError("yaw, pitch, roll, antenna: values that are not finite");
  if (!yaw && (pitch != 0 || roll != 0 || uncertainty.sigma_yaw > 0 || uncertainty.sigma_pitch > 0))
    throw Error(ExitCode::kUsage,
                "pose: pitch, roll, sigma_yaw and sigma_pitch are of a pose with yaw");
}

std::shared_ptr<mrpt::obs::CObservation> GeodeticPoses::observationOf(const GeodeticPose& pose) {
  pose.check();
  if (pose.yaw) return poseObservation(stateOf(pose));
  if (params_.source != EgoPoseParams::Source::kAuto &&
      params_.source != EgoPoseParams::Source::kFusion)
    throw Error(ExitCode::kUsage,
                "pose: latitude and longitude without yaw are read by [ego] source = auto or "
                "fusion; give the yaw, too, or one of these");
  return fixOf(pose, params_.fusion.gnss);
}

EgoState GeodeticPoses::stateOf(const GeodeticPose& pose) {
  if (!frame_) {
    const auto& origin = params_.fusion.origin;
    with_heights_ = pose.height.has_value();
    frame_.emplace(origin.size() == 3
                       ? Geodetic{origin[0], origin[1], origin[2]}
                       : Geodetic{pose.latitude, pose.longitude, pose.height.value_or(0)});
  }
  if (pose.height.has_value() != with_heights_)
    throw DataError("height: of all poses of a tracker or of none");
  const double height = pose.height.value_or(frame_->origin().height);
  EgoState ego;
  ego.stamp = pose.stamp;
  ego.T_world_ego = makePose(0, 0, 0, *pose.yaw, pose.pitch, pose.roll);
  Vector3 place = frame_->fromGeodetic({pose.latitude, pose.longitude, height});
  if (!with_heights_) place.z() = 0;
  ego.T_world_ego.translation() = place - ego.T_world_ego.linear() * pose.antenna;
  ego.uncertainty = pose.uncertainty;
  return ego;
}

}  // namespace perception
