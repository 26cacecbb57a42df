#include "studies/obstacles/ObstacleDrive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/Error.h"
#include "libperception/simulation/weather/WeatherChain.h"

namespace perception {
namespace {

constexpr double kLidarHeight = 1.73;                      // [m] KITTI's
constexpr double kWallOffset = 9, kWallHeight = 3;         // [m] assumed
constexpr double kBefore = 30, kBeyond = 60;               // [m] of walls: vehicle, shape
constexpr double kNextLane = -3.6;                         // [m] assumed
constexpr double kPassingSpeed = 25, kPassingEvery = 1.5;  // [m/s, s] assumed
constexpr double kDriveAcross = 3, kSharpestRadius = 25;   // [m/s^2, m] assumed
constexpr double kAzimuthStep = 0.2;                       // [deg]
constexpr double kOutlineStep = 0.05;                      // [m]
constexpr std::uint32_t kScanPurpose = 0x57DD0000;         // of random numbers

std::vector<double> evenly(double from_deg, double to_deg, int count) {
  std::vector<double> all;
  for (int i = 0; i < count; ++i)
    all.push_back(radians(from_deg + (to_deg - from_deg) * i / (count - 1)));
  return all;
}

SensorParams sensorOf(const ObstacleDriveParams& params) {
  SensorParams sensor;
  sensor.label = params.lidar;
  sensor.z = kLidarHeight;
  sensor.rate = ObstacleDrive::kRate;
  sensor.lidar = lidarOfBeams(params.beams);
  const double middle = params.way == DriveWay::kBackward ? kPi : 0;
  const double half = radians(0.5 * params.sector);
  sensor.lidar.azimuth_from = middle - half, sensor.lidar.azimuth_to = middle + half;
  return sensor;
}

ObjectParams standing(ObjectKind kind, const Pose3& pose, const Vector3& size, double base) {
  ObjectParams object;
  object.kind = kind;
  object.length = size.x(), object.width = size.y(), object.height = size.z();
  object.base = base;
  object.waypoints.t = {0};
  object.waypoints.x = {pose.translation().x()}, object.waypoints.y = {pose.translation().y()};
  object.waypoints.heading = yawOf(pose);
  return object;
}

Pose3 boxPose(const Pose3& T_world_shape, const ShapeBox& box) {
  return T_world_shape * makePose(box.x + 0.5 * box.length, box.y, 0, radians(box.yaw_deg));
}

// A car that passes the vehicle at t [s].
ObjectParams passingCar(double t, double speed, double until) {
  constexpr double kStart = -5;  // [s] before the first spray
  ObjectParams car = standing(ObjectKind::kCar, Pose3::Identity(), {4.5, 1.8, 1.5}, 0);
  const auto at = [&](double when) { return speed * t + kPassingSpeed * (when - t); };
  car.waypoints.t = {kStart, until};
  car.waypoints.x = {at(kStart), at(until)};
  car.waypoints.y = {kNextLane, kNextLane};
  return car;
}

}  // namespace

const std::vector<std::string>& driveWayNames() {
  static const std::vector<std::string> names = {"forward", "backward", "left", "right"};
  return names;
}

LidarSensorParams lidarOfBeams(int beams) {
  LidarSensorParams lidar;
  lidar.azimuth_step = radians(kAzimuthStep);
  if (beams == 16)
    lidar.rings = evenly(-15, 15, 16);
  else if (beams == 32)
    lidar.rings = evenly(-30.67, 10.67, 32);
  else if (beams == 128)
    lidar.rings = evenly(-25, 15, 128);
  else if (beams != 64)
    throw Error(ExitCode::kUsage, fmt::format("beams: found {}, expected 16, 32, 64, 128", beams));
  return lidar;
}

double curvatureOf(DriveWay way, double speed) {
  if (way == DriveWay::kForward || way == DriveWay::kBackward) return 0;
  const double radius = std::max(kSharpestRadius, speed * speed / kDriveAcross);
  return (way == DriveWay::kLeft ? 1 : -1) / radius;
}

ObstacleDrive::ObstacleDrive(const ObstacleDriveParams& params)
    : params_(params),
      curvature_(curvatureOf(params.way, params.speed)),
      sensor_(sensorOf(params)),
      world_(scenario()),
      caster_(world_),
      lidar_(sensor_.lidar, kRate),
      weather_(makeWeather(params.weather, world_.scenario(), params.seed)) {}

// The direction of travel, s [m] along the way.
Pose3 ObstacleDrive::placeAt(double s) const {
  if (curvature_ == 0) return makePose(s, 0, 0, 0);
  const double turned = curvature_ * s;
  return makePose(std::sin(turned) / curvature_, (1 - std::cos(turned)) / curvature_, 0, turned);
}

Scenario ObstacleDrive::scenario() const {
  Scenario scene;
  scene.params.duration = params_.distance / params_.speed;
  scene.params.ground_roughness = 0;
  scene.weather = params_.weather;
  for (double s = 0;; s += params_.speed / kRate) {
    const Vector3 place = placeAt(s).translation();
    scene.ego.waypoints.t.push_back(s / params_.speed);
    scene.ego.waypoints.x.push_back(place.x()), scene.ego.waypoints.y.push_back(place.y());
    if (s > params_.distance) break;
  }
  const Pose3 T_world_shape = placeAt(params_.distance);
  for (const ShapeBox& box : params_.shape->boxes) {
    scene.objects.push_back(standing(ObjectKind::kBox, boxPose(T_world_shape, box),
                                     {box.length, box.width, box.height}, box.base));
    scene.objects.back().reflectivity = box.reflectivity;
  }
  const double step = curvature_ == 0 ? 20 : 4;  // [m]
  for (double s = -kBefore; s < params_.distance + kBeyond; s += step)
    for (const double aside : {-kWallOffset, kWallOffset})
      scene.objects.push_back(standing(ObjectKind::kBox, placeAt(s) * makePose(0, aside, 0, 0),
                                       {step, 0.3, kWallHeight}, 0));
  const SimulatedWeatherParams& weather = params_.weather;
  const bool spray = weather.water_film_mm > 0 && weather.rain_mm_h <= 0 && curvature_ == 0;
  for (double t = 0; spray && t <= scene.params.duration; t += kPassingEvery)
    scene.objects.push_back(passingCar(t, params_.speed, scene.params.duration + 1));
  scene.sensors = {sensor_};
  return scene;
}

EgoState ObstacleDrive::ego(double t) const {
  const Pose3 travel = placeAt(params_.speed * t);
  EgoState ego;
  ego.stamp = world_.stamp(t);
  ego.T_world_ego =
      params_.way == DriveWay::kBackward ? Pose3(travel * makePose(0, 0, 0, kPi)) : travel;
  ego.velocity = params_.speed * Vector2(travel.linear().col(0).head<2>());
  ego.yaw_rate = curvature_ * params_.speed;
  ego.uncertainty = {0, 0, 0};
  return ego;
}

const LidarSensor::Scan& ObstacleDrive::scan(std::size_t k) {
  while (scans_.size() <= k) {
    const std::size_t number = scans_.size();
    const double t = static_cast<double>(number) / kRate;
    PulseHook hook;
    if (weather_) weather_->advance(world_, sensor_, t);
    if (weather_ && weather_->actsOnPulses())
      hook = [&](LidarPulse& pulse, Rng& rng) { weather_->alter(sensor_, pulse, rng); };
    const auto pose = [&](double at) -> Pose3 { return ego(at).T_world_ego * T_ego_lidar(); };
    scans_.push_back(lidar_.scan(caster_, t, pose, {params_.seed, number, 0, kScanPurpose}, hook));
  }
  return scans_[k];
}

bool ObstacleDrive::isOfShape(const LidarSensor::Scan& scan, std::size_t i) const {
  if (!scan.phantoms.empty() && scan.phantoms[i] != Phantom::kNone) return false;
  const int object = scan.surfaces[i];
  return object >= 0 && static_cast<std::size_t>(object) < params_.shape->boxes.size();
}

std::vector<Vector3> ObstacleDrive::outline(double height) const {
  std::vector<Vector3> points;
  const Pose3 T_world_shape = placeAt(params_.distance);
  for (const ShapeBox& box : params_.shape->boxes) {
    if (box.base >= height) continue;
    const Pose3 pose = boxPose(T_world_shape, box);
    const auto add = [&](double x, double y) {
      points.push_back(pose * Vector3(x * box.length, y * box.width, box.base));
    };
    const double around = std::max(box.length, box.width);
    const int steps = std::max(1, static_cast<int>(std::ceil(around / kOutlineStep)));
    for (int i = 0; i <= steps; ++i) {
      const double a = static_cast<double>(i) / steps - 0.5;
      add(a, -0.5), add(a, 0.5), add(-0.5, a), add(0.5, a);
    }
  }
  return points;
}

}  // namespace perception
