#include "libperception/simulation/recorded/WeatheredLog.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/frames/ToObservation.h"
#include "libperception/sensors/images/CameraImages.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/simulation/cameras/CameraBoxes.h"
#include "libperception/simulation/lidar/PointTruth.h"
#include "libperception/simulation/recorded/RecordedImage.h"
#include "libperception/simulation/recorded/RecordedScan.h"
#include "libperception/simulation/weather/Beam.h"
#include "libperception/simulation/weather/WeatherChain.h"

namespace perception {
namespace {

constexpr std::uint32_t kPurpose = 0x57EAF000, kFramePurpose = 0x57EAF800;
constexpr double kFarBox = 80;  // [m] of a box whose lower edge is above the horizon (assumed)

/// The sensor as the phenomena know it.
SensorParams sensorOf(const SensorFrame& frame) {
  SensorParams sensor;
  sensor.label = frame.sensor;
  Pose3 mount = frame.T_ego_sensor;
  if (const auto* cloud = std::get_if<LidarCloud>(&frame.data)) {
    sensor.kind = SensorKind::kLidar64;
    if (cloud->max_range > 0) sensor.lidar.range_max = cloud->max_range;
  } else if (std::holds_alternative<RadarReturns>(frame.data)) {
    sensor.kind = SensorKind::kRadar;
  } else {
    const bool image = std::holds_alternative<CameraImage>(frame.data);
    sensor.kind = image ? SensorKind::kCameraImages : SensorKind::kCameraBoxes;
    if (const auto* boxes = std::get_if<ObjectDetections>(&frame.data))
      mount = boxes->T_ego_camera.value_or(mount);
    mount = mount * opticalAxes().inverse();
  }
  const Eigen::Matrix3d r = mount.linear();
  sensor.x = mount.translation().x(), sensor.y = mount.translation().y();
  sensor.z = mount.translation().z();
  sensor.yaw = std::atan2(r(1, 0), r(0, 0));
  sensor.pitch = -std::asin(std::clamp(r(2, 0), -1.0, 1.0));
  sensor.roll = std::atan2(r(2, 1), r(2, 2));
  return sensor;
}

double detectionOf(double snr, double false_alarm) { return std::pow(false_alarm, 1 / (1 + snr)); }

}  // namespace

WeatheredLog::WeatheredLog(Scenario scene, Stamp first, std::uint64_t seed, int threads,
                           std::string images)
    : world_(std::move(scene)),
      caster_(world_, threads),
      first_(first),
      seed_(seed),
      images_(std::move(images)) {
  const Scenario& scenario = world_.scenario();
  weather_ = makeWeather(scenario.weather, scenario, seed);
  if (!weather_) weather_ = std::make_unique<SimulatedWeather>();
}

WeatheredLog::~WeatheredLog() = default;

std::string WeatheredLog::text() const {
  const std::string weather = world_.scenario().weather.text();
  return fmt::format("simulated weather on a recording: {}, seed {}",
                     weather.empty() ? "clear" : weather, seed_);
}

std::shared_ptr<mrpt::obs::CObservation> WeatheredLog::apply(
    const std::shared_ptr<mrpt::obs::CObservation>& observation) {
  labels_.reset();
  if (const auto number = frameNumber(*observation)) frame_ = *number;
  if (!isSensorData(*observation)) return observation;
  auto frame = frameFromObservation(*observation, nullptr, images_);
  if (!frame) return observation;  // a fault of the recording, which its readers report
  const SensorParams sensor = sensorOf(*frame);
  const double t = frame->stamp - first_;
  weather_->advance(world_, sensor, t);
  const std::uint64_t count = frames_of_[frame->sensor]++;
  const RngKey key{seed_, count, 0, streamOf(frame->sensor, kPurpose)};
  const Pose3 T_world_sensor = world_.ego(t).T_world_ego * frame->T_ego_sensor;
  if (std::holds_alternative<LidarCloud>(frame->data)) {
    alterScan(sensor, t, key, *frame);
  } else if (auto* radar = std::get_if<RadarReturns>(&frame->data)) {
    alterReturns(sensor, key, *radar, T_world_sensor);
  } else if (std::holds_alternative<CameraImage>(frame->data)) {
    ++counts_.images;
    if (!alterImage(sensor, t, key, *frame)) {
      ++counts_.images_left_out;
      return nullptr;
    }
  } else if (auto* boxes = std::get_if<ObjectDetections>(&frame->data)) {
    const Pose3 mount = boxes->T_ego_camera.value_or(frame->T_ego_sensor);
    alterBoxes(sensor, key, *boxes, world_.ego(t).T_world_ego * mount);
  }
  Rng rng({seed_, count, 0, streamOf(frame->sensor, kFramePurpose)});
  weather_->alter(sensor, *frame, rng);
  return observationFromFrame(*frame);
}

bool WeatheredLog::alterImage(const SensorParams& sensor, double t, const RngKey& key,
                              SensorFrame& frame) {
  auto& image = std::get<CameraImage>(frame.data);
  const auto pixels = image.load ? image.load() : std::nullopt;
  if (!pixels) return false;
  CameraView view;
  view.camera = image.camera;
  view.camera.width = pixels->width, view.camera.height = pixels->height;
  if (view.camera.fx <= 0 || view.camera.fy <= 0) {
    const auto panorama = panoramaModel(pixels->width, pixels->height);
    if (!panorama) return false;
    view.camera = *panorama;
  }
  const EgoState ego = world_.ego(t);
  view.T_world_camera = ego.T_world_ego * frame.T_ego_sensor;
  view.velocity << ego.velocity, 0;
  std::vector<Vector3> returns;
  for (const auto& [lidar, last] : returns_)
    returns.insert(returns.end(), last.begin(), last.end());
  image.camera = view.camera;
  image.load = [raster = std::make_shared<const Raster>(throughWeather(
                    *pixels, std::move(view), returns, *weather_, sensor, caster_, key))] {
    return std::optional<Raster>(*raster);
  };
  return true;
}

void WeatheredLog::alterScan(const SensorParams& sensor, double t, const RngKey& key,
                             SensorFrame& frame) {
  auto& cloud = std::get<LidarCloud>(frame.data);
  caster_.setTime(t);
  const Pose3 T_world_sensor = world_.ego(t).T_world_ego * frame.T_ego_sensor;
  std::vector<Vector3>& last = returns_[frame.sensor];
  last.clear();
  for (std::size_t i = 0; i < cloud.size(); ++i)
    last.push_back(T_world_sensor * Vector3(cloud.x[i], cloud.y[i], cloud.z[i]));
  const auto missing = patterns_[frame.sensor].missing(cloud);
  WeatheredScan scan =
      throughWeather(cloud, missing, *weather_, sensor, T_world_sensor, caster_, key);
  ++counts_.scans;
  counts_.returns += cloud.size(), counts_.lost += scan.lost;
  counts_.phantoms += static_cast<std::uint64_t>(std::count_if(
      scan.phantoms.begin(), scan.phantoms.end(), [](Phantom p) { return p != Phantom::kNone; }));
  labels_.emplace();
  for (const Phantom p : scan.phantoms) labels_->push_back(labelOf(p));
  cloud = std::move(scan.cloud);
}

// The signal of a recorded target is not known in watts: that of a car at its range.
void WeatheredLog::alterReturns(const SensorParams& sensor, const RngKey& key, RadarReturns& radar,
                                const Pose3& T_world_sensor) {
  const RadarUnitParams& unit = sensor.radar;
  std::vector<RadarReturn> kept;
  for (std::size_t i = 0; i < radar.returns.size(); ++i) {
    RadarReturn r = radar.returns[i];
    RadarReflection target;
    target.range = r.range, target.bearing = r.bearing, target.range_rate = r.range_rate;
    target.position =
        (T_world_sensor * Vector3(r.range * std::cos(r.bearing), r.range * std::sin(r.bearing), 0))
            .head<2>();
    const double clear = carSnr(std::max(r.range, 1.0), unit);
    target.snr = clear;
    Rng rng(key.withSlot(static_cast<std::uint32_t>(i)));
    weather_->alter(sensor, target, rng);
    ++counts_.targets;
    const double share = target.snr <= 0 ? 0
                                         : detectionOf(target.snr, unit.false_alarm) /
                                               detectionOf(clear, unit.false_alarm);
    if (rng.uniform() >= share) {
      ++counts_.targets_lost;
      continue;
    }
    r.amplitude += 10 * std::log10(target.snr / clear);
    kept.push_back(r);
  }
  radar.returns = std::move(kept);
}

// A box is as far away as the road at its lower edge. Boxes in space alone come from other sensors
// and stay.
void WeatheredLog::alterBoxes(const SensorParams& sensor, const RngKey& key,
                              ObjectDetections& detections, const Pose3& T_world_camera) {
  const CameraModel& camera = detections.camera;
  const double clear_noise = sensor.camera.edge_noise;
  std::vector<ObjectDetection> kept;
  for (std::size_t i = 0; i < detections.objects.size(); ++i) {
    ObjectDetection d = detections.objects[i];
    if (!d.image_box || camera.fx <= 0) {
      kept.push_back(std::move(d));
      continue;
    }
    auto& box = *d.image_box;
    const double x = .5 * (box.x1 + box.x2) - camera.cx, y = box.y2 - camera.cy;
    const bool panorama = camera.projection == CameraModel::Projection::kEquirectangular;
    const double azimuth = panorama ? x / camera.fx : std::atan2(x, camera.fx);
    const double down =
        panorama ? y / camera.fy : std::atan2(y, std::hypot(camera.fx, x) * camera.fy / camera.fx);
    const double height = T_world_camera.translation().z();
    CameraLook look;
    look.object = i;
    look.range = down > 0 ? std::min(kFarBox, height / std::tan(down)) : kFarBox;
    look.azimuth = yawOf(T_world_camera * opticalAxes().inverse()) - azimuth;
    look.chance = 1, look.edge_noise = clear_noise;
    Rng rng(key.withSlot(static_cast<std::uint32_t>(i)));
    weather_->alter(sensor, look, rng);
    look.chance *= contrastRecall(look.optical_depth);
    ++counts_.boxes;
    if (rng.uniform() >= look.chance) {
      ++counts_.boxes_lost;
      continue;
    }
    const double added =
        std::sqrt(std::max(0.0, look.edge_noise * look.edge_noise - clear_noise * clear_noise));
    const double tall = box.y2 - box.y1;
    for (double* edge : {&box.x1, &box.y1, &box.x2, &box.y2}) *edge += added * tall * rng.normal();
    if (box.x2 <= box.x1 || box.y2 <= box.y1) {
      ++counts_.boxes_lost;
      continue;
    }
    kept.push_back(std::move(d));
  }
  detections.objects = std::move(kept);
}

}  // namespace perception
