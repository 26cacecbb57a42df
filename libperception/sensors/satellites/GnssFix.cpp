#include "libperception/sensors/satellites/GnssFix.h"

#include <mrpt/topography/conversions.h>

#include <cmath>

#include "libperception/sensors/observations/Conversions.h"

namespace perception {

namespace {

using mrpt::obs::CObservationGPS;
namespace gnss = mrpt::obs::gnss;

constexpr double kKnot = 1852.0 / 3600;  // [m/s]
constexpr double kDifferential = 0.5;    // [-] of the plain sigma: DGPS, SBAS
constexpr double kFloat = 0.25;          // [-] of the plain sigma: RTK without fixed ambiguities
constexpr double kEstimated = 4;         // [-] of the plain sigma: dead reckoning of the receiver
constexpr double kInsYawSigma = radians(1);  // [rad] default of a receiver's INS
constexpr double kCourseSpeed = 1.0;         // [m/s] least speed of a valid course

bool onEarth(double latitude, double longitude) {
  // Receivers without a position send 0, 0.
  return std::isfinite(latitude + longitude) && std::abs(latitude) <= 90 &&
         std::abs(longitude) <= 180 && (latitude != 0 || longitude != 0);
}

void setSigma(GnssFix& fix, double sigma, const GnssParams& params) {
  fix.sigma = sigma;
  fix.height_sigma = params.height_factor * sigma;
}

std::optional<GnssFix> fromGga(const gnss::Message_NMEA_GGA& gga, const GnssParams& params) {
  const auto& f = gga.fields;
  if (!onEarth(f.latitude_degrees, f.longitude_degrees)) return {};
  GnssFix fix;
  fix.place = {f.latitude_degrees, f.longitude_degrees, f.altitude_meters + f.geoidal_distance};
  const double hdop = f.thereis_HDOP && f.HDOP > 0 ? static_cast<double>(f.HDOP) : 1;
  switch (f.fix_quality) {  // NMEA 0183
    case 1:
    case 8:
      setSigma(fix, params.sigma * hdop, params);
      break;
    case 2:
    case 3:
      setSigma(fix, kDifferential * params.sigma * hdop, params);
      break;
    case 4:
      setSigma(fix, params.rtk_sigma, params);
      break;
    case 5:
      setSigma(fix, kFloat * params.sigma, params);
      break;
    case 6:
      setSigma(fix, kEstimated * params.sigma * hdop, params);
      break;
    default:  // 0: no fix, 7: manual input
      return {};
  }
  return fix;
}

template <class Message>
std::optional<GnssFix> fromPlain(const Message& message, const GnssParams& params) {
  const auto& f = message.fields;
  if (f.validity_char != 'A' || !onEarth(f.latitude_degrees, f.longitude_degrees)) return {};
  GnssFix fix;
  fix.place = {f.latitude_degrees, f.longitude_degrees, 0};
  fix.has_height = false;
  setSigma(fix, params.sigma, params);
  return fix;
}

std::optional<GnssFix> fromBestpos(const gnss::Message_NV_OEM6_BESTPOS& best) {
  const auto& f = best.fields;
  if (f.solution_stat != gnss::nv_oem6_solution_status::SOL_COMPUTED || !onEarth(f.lat, f.lon))
    return {};
  GnssFix fix;
  fix.place = {f.lat, f.lon, f.hgt + static_cast<double>(f.undulation)};
  fix.sigma = std::hypot(f.lat_sigma, f.lon_sigma) / std::sqrt(2.0);
  fix.height_sigma = static_cast<double>(f.hgt_sigma);
  if (!(fix.sigma > 0) || !(fix.height_sigma > 0)) return {};
  return fix;
}

std::optional<GnssFix> fromInspvas(const gnss::Message_NV_OEM6_INSPVAS& ins,
                                   const gnss::Message_NV_OEM6_INSCOVS* covs,
                                   const GnssParams& params) {
  const auto& f = ins.fields;
  if (f.ins_status != gnss::nv_oem6_ins_status_type::INS_SOLUTION_GOOD || !onEarth(f.lat, f.lon))
    return {};
  GnssFix fix;
  fix.place = {f.lat, f.lon, f.hgt};
  setSigma(fix, params.sigma, params);
  fix.has_velocity = true;
  fix.velocity = Vector2(f.vel_east, f.vel_north);
  fix.velocity_sigma = params.velocity_sigma;
  fix.yaw = wrapAngle(radians(90 - f.azimuth));  // clockwise from north
  fix.yaw_sigma = kInsYawSigma;
  if (covs != nullptr) {
    const auto& c = covs->fields;
    const double position = (c.pos_cov[0] + c.pos_cov[4]) / 2, height = c.pos_cov[8];
    if (position > 0 && height > 0)
      fix.sigma = std::sqrt(position), fix.height_sigma = std::sqrt(height);
    if (c.att_cov[8] > 0) fix.yaw_sigma = radians(std::sqrt(c.att_cov[8]));
    if (c.vel_cov[0] + c.vel_cov[4] > 0)
      fix.velocity_sigma = std::sqrt((c.vel_cov[0] + c.vel_cov[4]) / 2);
  }
  return fix;
}

/// The message of a class, or null (in MRPT 2.5.8 the const getMsgByClassPtr() does not compile).
template <class Message>
const Message* messageOf(const CObservationGPS& o) {
  const auto it = o.messages.find(static_cast<gnss::gnss_message_type_t>(Message::msg_type));
  if (it == o.messages.end()) return nullptr;
  const gnss::gnss_message* message = it->second.get();
  return dynamic_cast<const Message*>(message);
}

Geodetic fromCartesian(const Vector3& p) {
  mrpt::topography::TGeodeticCoords out;
  mrpt::topography::geocentricToGeodetic({p.x(), p.y(), p.z()}, out);
  return {out.lat.getDecimalValue(), out.lon.getDecimalValue(), out.height};
}

/// East and north components of a velocity in Earth's cartesian axes.
Vector2 horizontalPart(const Vector3& v, const Geodetic& place) {
  const double la = radians(place.latitude), lo = radians(place.longitude);
  return {-std::sin(lo) * v.x() + std::cos(lo) * v.y(), -std::sin(la) * std::cos(lo) * v.x() -
                                                            std::sin(la) * std::sin(lo) * v.y() +
                                                            std::cos(la) * v.z()};
}

std::optional<GnssFix> fromTopcon(const gnss::Message_TOPCON_PZS& pzs, const GnssParams& params) {
  GnssFix fix;
  if (onEarth(pzs.latitude_degrees, pzs.longitude_degrees)) {
    fix.place = {pzs.latitude_degrees, pzs.longitude_degrees, pzs.height_meters};
  } else if (pzs.hasCartesianPosVel) {
    const Vector3 p(pzs.cartesian_x, pzs.cartesian_y, pzs.cartesian_z);
    if (!p.allFinite() || p.norm() < 6e6) return {};  // [m] inside the Earth
    fix.place = fromCartesian(p);
  } else {
    return {};
  }
  setSigma(fix, pzs.PSigma > 0 ? static_cast<double>(pzs.PSigma) : params.sigma, params);
  if (pzs.hasPosCov) {
    // Cartesian axes: one deviation for all directions.
    const auto& c = pzs.pos_covariance;
    const double mean = static_cast<double>(c(0, 0) + c(1, 1) + c(2, 2)) / 3;
    if (std::isfinite(mean) && mean > 0) setSigma(fix, std::sqrt(mean), params);
  }
  if (pzs.hasCartesianPosVel) {
    const Vector3 v(pzs.cartesian_vx, pzs.cartesian_vy, pzs.cartesian_vz);
    fix.has_velocity = v.allFinite();
    if (fix.has_velocity) fix.velocity = horizontalPart(v, fix.place);
    fix.velocity_sigma = params.velocity_sigma;
  }
  return fix;
}

/// Speed and course of RMC or VTG; courses at rest are noise.
void addCourse(const CObservationGPS& o, const GnssParams& params, GnssFix& fix) {
  double speed = 0, course = 0;
  if (const auto* rmc = messageOf<gnss::Message_NMEA_RMC>(o);
      rmc != nullptr && rmc->fields.validity_char == 'A') {
    speed = rmc->fields.speed_knots * kKnot, course = rmc->fields.direction_degrees;
  } else if (const auto* vtg = messageOf<gnss::Message_NMEA_VTG>(o)) {
    speed = vtg->fields.ground_speed_knots * kKnot, course = vtg->fields.true_track;
  }
  if (!std::isfinite(speed + course) || speed < kCourseSpeed) return;
  const double yaw = radians(90 - course);
  fix.has_velocity = true;
  fix.velocity = speed * Vector2(std::cos(yaw), std::sin(yaw));
  fix.velocity_sigma = params.velocity_sigma;
}

std::optional<GnssFix> bestOf(const CObservationGPS& o, const GnssParams& params) {
  if (const auto* m = messageOf<gnss::Message_NV_OEM6_INSPVAS>(o)) {
    const auto* covs = messageOf<gnss::Message_NV_OEM6_INSCOVS>(o);
    if (auto fix = fromInspvas(*m, covs, params)) return fix;
  }
  if (const auto* m = messageOf<gnss::Message_NV_OEM6_BESTPOS>(o)) {
    if (auto fix = fromBestpos(*m)) return fix;
  }
  if (const auto* m = messageOf<gnss::Message_TOPCON_PZS>(o)) {
    if (auto fix = fromTopcon(*m, params)) return fix;
  }
  // A GGA without a fix is not replaced by the RMC beside it.
  if (const auto* m = messageOf<gnss::Message_NMEA_GGA>(o)) return fromGga(*m, params);
  if (const auto* m = messageOf<gnss::Message_NMEA_RMC>(o)) return fromPlain(*m, params);
  if (const auto* m = messageOf<gnss::Message_NMEA_GLL>(o)) return fromPlain(*m, params);
  return {};
}

}  // namespace

void GnssParams::visit(ParamVisitor& v) {
  v.real("gnss_sigma", sigma, {0.001, 100}, "m",
         "of a plain fix at HDOP 1, for receivers that do not report it");
}

std::optional<GnssFix> gnssFix(const CObservationGPS& observation, const GnssParams& params) {
  const auto stamp = toStamp(observation.timestamp);
  if (!stamp) return {};
  auto fix = bestOf(observation, params);
  if (!fix || !std::isfinite(fix->place.height)) return {};
  if (!fix->has_velocity) addCourse(observation, params, *fix);
  fix->stamp = *stamp;
  fix->antenna = toPose3(observation.sensorPose).translation();
  return fix;
}

Vector3 LocalFrame::fromGeodetic(const Geodetic& place) const {
  mrpt::math::TPoint3D enu;
  mrpt::topography::geodeticToENU_WGS84({place.latitude, place.longitude, place.height}, enu,
                                        {origin_.latitude, origin_.longitude, origin_.height});
  return {enu.x, enu.y, enu.z};
}

// Own code: ENUToGeocentric() of MRPT 2.5.8 has an error of 2 m at a distance of 1.6 km.
Geodetic LocalFrame::toGeodetic(const Vector3& enu) const {
  const double la = radians(origin_.latitude), lo = radians(origin_.longitude);
  const Vector3 east(-std::sin(lo), std::cos(lo), 0);
  const Vector3 up(std::cos(la) * std::cos(lo), std::cos(la) * std::sin(lo), std::sin(la));
  mrpt::math::TPoint3D earth;
  mrpt::topography::geodeticToGeocentric_WGS84(
      {origin_.latitude, origin_.longitude, origin_.height}, earth);
  return fromCartesian(Vector3(earth.x, earth.y, earth.z) + enu.x() * east +
                       enu.y() * up.cross(east) + enu.z() * up);
}

}  // namespace perception
