#include "libperception/simulation/EgoSensors.h"

#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libperception/core/PoseSteps.h"
#include "libperception/sensors/ego/CEgoFilter.h"  // kGravity
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/satellites/GnssFix.h"

namespace perception {
namespace {

/// The counter of what is drawn once a log.
constexpr std::uint64_t kOnce = std::numeric_limits<std::uint64_t>::max();
constexpr double kKnot = 1852.0 / 3600;  // [m/s]
constexpr double kStanding = 1e-3;       // [m/s] lower speeds are measured as 0

Vector3 normals(Rng& rng, double sigma) {
  const double x = rng.normal(), y = rng.normal(), z = rng.normal();
  return sigma * Vector3(x, y, z);
}

/// What is drawn once a log, a number of the standard normal distribution an axis.
Vector3 drawnOnce(const RngKey& key) {
  Rng rng({key.seed, kOnce, key.slot, key.purpose});
  return normals(rng, 1);
}

/// Velocity of a point of the vehicle [m/s], world.
Vector3 velocityOf(const EgoTruth& truth, const Vector3& point, double t) {
  const EgoState ego = truth.at(t);
  const Vector3 arm = ego.T_world_ego.linear() * point;
  const Vector3 w(0, 0, ego.yaw_rate);
  Vector3 velocity = w.cross(arm);
  velocity.head<2>() += ego.velocity;
  return velocity;
}

template <class Class>
std::shared_ptr<Class> observationAt(const EgoMount& mount, const EgoTruth& truth, double t) {
  auto observation = std::make_shared<Class>();
  observation->timestamp = fromStamp(truth.stamp(t));
  observation->sensorLabel = mount.label;
  observation->setSensorPose(toMrpt(mount.T_ego_sensor));
  return observation;
}

}  // namespace

void GnssUnitParams::visit(ParamVisitor& v) {
  v.real("sigma", sigma, {0, 100}, "m", "of a fix, east and north each, independent");
  v.real("height_sigma", height_sigma, {0, 100}, "m", "of its height");
  v.real("delay", delay, {0, 5}, "s", "latency of a fix in the log; its stamp is the true one");
  v.reals("gap_from", gap_from, -1, {0, 3600}, "s", "beginnings of times without satellites");
  v.reals("gap_to", gap_to, -1, {0, 3600}, "s", "their ends");
  v.real("height", height, {-500, 9000}, "m", "of the scene's origin above the ellipsoid");
  v.require(gap_from.size() == gap_to.size(), "gap_from, gap_to: expected as many of each");
  v.expert();
  v.boolean("velocity", velocity, "speed and course (RMC) beside the position (GGA)");
  v.real("latitude", latitude, {-89, 89}, "deg", "of the scene's origin, north");
  v.real("longitude", longitude, {-180, 180}, "deg", "of the scene's origin, east");
}

void ImuUnitParams::visit(ParamVisitor& v) {
  v.angle("gyro_noise_deg", gyro_noise, {0, 10}, "angle random walk, in one second");
  v.angle("gyro_bias_deg", gyro_bias, {0, 20}, "per second: deviation of an axis' bias");
  v.real("accel_noise", accel_noise, {0, 10}, "m/s", "velocity random walk, in one second");
  v.real("accel_bias", accel_bias, {0, 5}, "m/s^2", "deviation of an axis' bias");
}

void WheelUnitParams::visit(ParamVisitor& v) {
  v.real("sigma", sigma, {0, 5}, "m/s", "of one reading");
  v.real("scale", scale, {0, 0.5}, "-", "standard deviation of the scale error: tires, pressure");
}

std::shared_ptr<mrpt::obs::CObservation> gnssObservation(const GnssUnitParams& params,
                                                         const EgoMount& mount,
                                                         const EgoTruth& truth, double t,
                                                         const RngKey& key) {
  const double at = t - params.delay;
  for (std::size_t i = 0; i < params.gap_from.size(); ++i) {
    if (at >= params.gap_from[i] && at < params.gap_to[i]) return nullptr;
  }
  Rng rng(key);
  const Vector3 antenna = mount.T_ego_sensor.translation();
  Vector3 place = truth.at(at).T_world_ego * antenna;
  place.x() += rng.normal(0, params.sigma);
  place.y() += rng.normal(0, params.sigma);
  place.z() += rng.normal(0, params.height_sigma);
  Vector3 velocity = velocityOf(truth, antenna, at) + normals(rng, params.velocity_sigma);
  const Geodetic fix =
      LocalFrame({params.latitude, params.longitude, params.height}).toGeodetic(place);

  auto observation = observationAt<mrpt::obs::CObservationGPS>(mount, truth, at);
  observation->has_satellite_timestamp = true;
  mrpt::obs::gnss::Message_NMEA_GGA gga;
  gga.fields.latitude_degrees = fix.latitude;
  gga.fields.longitude_degrees = fix.longitude;
  gga.fields.altitude_meters = fix.height;
  gga.fields.fix_quality = 1;
  gga.fields.satellitesUsed = 9;
  gga.fields.thereis_HDOP = true;
  gga.fields.HDOP = 1;
  observation->setMsg(gga);
  if (params.velocity) {
    mrpt::obs::gnss::Message_NMEA_RMC rmc;
    rmc.fields.latitude_degrees = fix.latitude;
    rmc.fields.longitude_degrees = fix.longitude;
    rmc.fields.validity_char = 'A';
    rmc.fields.positioning_mode = 'A';
    rmc.fields.speed_knots = velocity.head<2>().norm() / kKnot;
    const double course = 90 - degrees(std::atan2(velocity.y(), velocity.x()));
    rmc.fields.direction_degrees = course < 0 ? course + 360 : course;
    observation->setMsg(rmc);
  }
  return observation;
}

std::shared_ptr<mrpt::obs::CObservation> imuObservation(const ImuUnitParams& params,
                                                        const EgoMount& mount,
                                                        const EgoTruth& truth, double t,
                                                        const RngKey& key) {
  Rng rng(key);
  const double dt = 1 / mount.rate, per_reading = std::sqrt(mount.rate);
  const Vector3 point = mount.T_ego_sensor.translation();
  const double from = std::max(0.0, t - dt), to = from + dt;  // nothing is known before t = 0
  const Pose3 before = truth.at(from).T_world_ego, now = truth.at(to).T_world_ego;
  const Pose3 middle = truth.at((from + to) / 2).T_world_ego;
  // Means over the reading's time: what the unit itself integrates.
  const Vector3 turned = turnOf(before.inverse() * now) / dt;
  const Vector3 pushed = (velocityOf(truth, point, to) - velocityOf(truth, point, from)) / dt;
  const Eigen::Matrix3d to_unit = (middle.linear() * mount.T_ego_sensor.linear()).transpose();
  Vector3 rates = mount.T_ego_sensor.linear().transpose() * turned;
  rates += params.gyro_bias * drawnOnce(key) + normals(rng, params.gyro_noise * per_reading);
  Vector3 force = to_unit * (pushed + Vector3(0, 0, kGravity));
  force += params.accel_bias * drawnOnce(key.withSlot(1)) +
           normals(rng, params.accel_noise * per_reading);
  const Vector3 shaking = normals(rng, params.vibration);
  force += mount.T_ego_sensor.linear().transpose() * Vector3(0, shaking.y(), shaking.z());

  auto observation = observationAt<mrpt::obs::CObservationIMU>(mount, truth, t);
  observation->set(mrpt::obs::IMU_WX, rates.x());
  observation->set(mrpt::obs::IMU_WY, rates.y());
  observation->set(mrpt::obs::IMU_WZ, rates.z());
  observation->set(mrpt::obs::IMU_X_ACC, force.x());
  observation->set(mrpt::obs::IMU_Y_ACC, force.y());
  observation->set(mrpt::obs::IMU_Z_ACC, force.z());
  return observation;
}

std::shared_ptr<mrpt::obs::CObservation> wheelObservation(const WheelUnitParams& params,
                                                          const EgoMount& mount,
                                                          const EgoTruth& truth, double t,
                                                          const RngKey& key) {
  Rng rng(key);
  const EgoState ego = truth.at(t);
  const double speed = ego.velocity.dot((ego.T_world_ego.linear() * Vector3::UnitX()).head<2>());
  const bool stands = std::abs(speed) < kStanding;
  const double scale = 1 + params.scale * drawnOnce(key).x();
  auto observation = observationAt<mrpt::obs::CObservationOdometry>(mount, truth, t);
  observation->hasVelocities = true;
  observation->velocityLocal.vx = stands ? 0 : scale * speed + rng.normal(0, params.sigma);
  observation->velocityLocal.vy = 0;
  observation->velocityLocal.omega =
      stands ? 0 : ego.yaw_rate + rng.normal(0, params.yaw_rate_sigma);
  return observation;
}

}  // namespace perception
