#include "libperception/simulation/Simulator.h"

#include <fmt/format.h>
#include <mrpt/obs/CObservationComment.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "libperception/sensors/frames/ToObservation.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/simulation/TruthVisibility.h"
#include "libperception/simulation/cameras/CameraView.h"
#include "libperception/simulation/lidar/PointTruth.h"
#include "libperception/simulation/weather/WeatherChain.h"

namespace perception {
namespace {

// Purposes of random numbers; a sensor adds its index.
constexpr std::uint32_t kPoseStream = 0x51B00, kSensorStream = 0x51C00, kFrameStream = 0x51E00;

std::int64_t ticksOf(double t) { return std::llround(t * 1e7); }

}  // namespace

Simulator::Simulator(Scenario scenario, const std::string& name, std::uint64_t seed, int threads)
    : world_(std::move(scenario)),
      caster_(world_, threads),
      name_(name),
      seed_(seed),
      pose_rng_({seed, 0, 0, kPoseStream}) {
  const Scenario& s = world_.scenario();
  schedule(Event::kComment, 0, 1 / (2 * s.params.duration), 0);
  if (s.ego.pose.rate > 0) schedule(Event::kPose, 0, s.ego.pose.rate, 0);
  schedule(Event::kFrame, 0, s.params.rate, 0);
  for (std::size_t i = 0; i < s.sensors.size(); ++i) {
    schedule(Event::kSensor, i, s.sensors[i].rate, s.sensors[i].phase);
    lidars_.emplace_back(s.sensors[i].lidar, s.sensors[i].rate);
  }
  std::sort(events_.begin(), events_.end(), [](const Event& a, const Event& b) {
    return std::tie(a.ticks, a.kind, a.sensor) < std::tie(b.ticks, b.kind, b.sensor);
  });
  weather_ = makeWeather(s.weather, s, seed);
  points_on_.assign(s.sensors.size(), std::vector<int>(world_.objects(), 0));
  scanned_.assign(s.sensors.size(), false);
}

void Simulator::schedule(Event::Kind kind, std::size_t sensor, double rate, double phase) {
  const double duration = world_.scenario().params.duration;
  for (std::uint64_t k = 0;; ++k) {
    const double t = phase + static_cast<double>(k) / rate;
    if (t > duration + 1e-9) return;
    events_.push_back({kind, t, ticksOf(t), sensor, k});
  }
}

std::shared_ptr<mrpt::obs::CObservation> Simulator::next() {
  while (next_ < events_.size()) {
    const Event& event = events_[next_++];
    if (auto observation = play(event)) return observation;
    // A GNSS receiver has no output in a gap; for other sensors null means a missing observation
    // class.
    const bool own =
        event.kind == Event::kSensor && world_.scenario().sensors[event.sensor].isOfEgo();
    unwritten_ += own ? 0 : 1;
  }
  endFrame();
  return nullptr;
}

std::shared_ptr<mrpt::obs::CObservation> Simulator::play(const Event& event) {
  switch (event.kind) {
    case Event::kComment: {
      auto comment = std::make_shared<mrpt::obs::CObservationComment>();
      comment->timestamp = fromStamp(world_.stamp(event.t));
      comment->sensorLabel = "SIMULATED";
      comment->text = fmt::format("{}scenario {}, seed {}", kSimulatedText, name_, seed_);
      const std::string& description = world_.scenario().params.description;
      if (!description.empty()) comment->text += ": " + description;
      const std::string weather = world_.scenario().weather.text();
      if (!weather.empty()) comment->text += "; weather: " + weather;
      return comment;
    }
    case Event::kPose:
      return poseObservation(reportedEgo(event.t));
    case Event::kFrame:
      beginFrame(event);
      return frameComment(world_.stamp(event.t), static_cast<std::int64_t>(event.count));
    case Event::kSensor:
      break;
  }
  return sense(event);
}

// The truth of a frame is completed after its scans, whose returns it counts.
void Simulator::beginFrame(const Event& event) {
  endFrame();
  ++frames_;
  open_ = world_.truth(static_cast<std::int64_t>(event.count), event.t);
  setVisibility(world_, caster_, event.t, open_);
  std::fill(scanned_.begin(), scanned_.end(), false);
}

void Simulator::endFrame() {
  const auto& sensors = world_.scenario().sensors;
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    if (!sensors[s].isLidar()) continue;
    for (TruthObject& row : open_) {
      row.lidar_points =
          std::max(0, row.lidar_points) + points_on_[s][static_cast<std::size_t>(row.id) - 1];
    }
  }
  truth_.insert(truth_.end(), open_.begin(), open_.end());
  open_.clear();
}

// The pose estimator's error: first-order Gauss-Markov, as a filter's error varies slowly.
EgoState Simulator::reportedEgo(double t) {
  const PoseParams& p = world_.scenario().ego.pose;
  const Vector3 sigma(p.sigma_xy, p.sigma_xy, p.sigma_yaw);
  const double keep = pose_error_drawn_ ? std::exp(-(t - pose_error_time_) / p.correlation) : 0;
  for (int i = 0; i < 3; ++i) {
    pose_error_(i) =
        keep * pose_error_(i) + std::sqrt(1 - keep * keep) * sigma(i) * pose_rng_.normal();
  }
  pose_error_time_ = t;
  pose_error_drawn_ = true;
  EgoState ego = world_.ego(t);
  const Vector3 place = ego.T_world_ego.translation();
  ego.T_world_ego = makePose(place.x() + pose_error_.x(), place.y() + pose_error_.y(), place.z(),
                             yawOf(ego.T_world_ego) + pose_error_.z());
  return ego;
}

std::shared_ptr<mrpt::obs::CObservation> Simulator::feelEgo(const Event& event) {
  const SensorParams& sensor = world_.scenario().sensors[event.sensor];
  const EgoMount mount{sensor.label, sensor.T_ego_sensor(), sensor.rate};
  const EgoTruth truth{[this](double t) { return world_.ego(t); },
                       [this](double t) { return world_.stamp(t); }};
  const RngKey key{seed_, event.count, 0, kSensorStream + static_cast<std::uint32_t>(event.sensor)};
  switch (sensor.kind) {
    case SensorKind::kGnss:
      return gnssObservation(sensor.gnss, mount, truth, event.t, key);
    case SensorKind::kImu:
      return imuObservation(sensor.imu, mount, truth, event.t, key);
    default:
      return wheelObservation(sensor.wheels, mount, truth, event.t, key);
  }
}

std::shared_ptr<mrpt::obs::CObservation> Simulator::sense(const Event& event) {
  const SensorParams& sensor = world_.scenario().sensors[event.sensor];
  if (sensor.isOfEgo()) return feelEgo(event);
  const RngKey key{seed_, event.count, 0, kSensorStream + static_cast<std::uint32_t>(event.sensor)};
  SensorFrame frame;
  frame.sensor = sensor.label;
  frame.stamp = world_.stamp(event.t);
  frame.T_ego_sensor = sensor.T_ego_sensor();
  if (weather_) weather_->advance(world_, sensor, event.t);
  if (sensor.isLidar()) {
    frame.data = scanLidar(event, key);
  } else if (sensor.isCamera()) {
    frame.T_ego_sensor = frame.T_ego_sensor * opticalAxes();
    const Pose3 T_world_camera = world_.ego(event.t).T_world_ego * frame.T_ego_sensor;
    if (sensor.kind == SensorKind::kCameraImages) {
      caster_.setTime(event.t);
      frame.data = takeImage(event, T_world_camera, key);
      ++images_;
    } else {
      frame.data = seeObjects(event, T_world_camera, key);
    }
  } else {
    frame.data = listenRadar(event, key);
  }
  if (weather_) {
    Rng rng(key.withPurpose(kFrameStream + static_cast<std::uint32_t>(event.sensor)));
    weather_->alter(sensor, frame, rng);
  }
  try {
    return observationFromFrame(frame);
  } catch (const std::bad_variant_access&) {
    return nullptr;  // no observation class for it
  }
}

ObjectDetections Simulator::seeObjects(const Event& event, const Pose3& T_world_camera,
                                       const RngKey& key) {
  const SensorParams& sensor = world_.scenario().sensors[event.sensor];
  CameraHook hook;
  if (weather_) hook = [&](CameraLook& look, Rng& rng) { weather_->alter(sensor, look, rng); };
  caster_.setTime(event.t);
  ObjectDetections boxes =
      sensor.kind == SensorKind::kSphericalCamera
          ? detectPanorama(caster_, event.t, sensor.panorama, T_world_camera, key, hook)
          : detectBoxes(caster_, event.t, sensor.camera, T_world_camera, key, hook);
  boxes_ += boxes.objects.size();
  return boxes;
}

CameraImage Simulator::takeImage(const Event& event, const Pose3& T_world_camera,
                                 const RngKey& key) const {
  const SensorParams& sensor = world_.scenario().sensors[event.sensor];
  Lighting light = world_.scenario().light;
  if (weather_) {
    Rng rng(key);
    weather_->alter(sensor, light, rng);
  }
  CameraImage image;
  image.camera = sensor.cameraModel();
  image.source = "simulated";
  CameraView view;
  Raster pixels = std::move(
      renderImage(caster_, event.t, image.camera, light, T_world_camera, weather_ ? &view : nullptr)
          .raster);
  if (weather_) {
    const EgoState ego = world_.ego(event.t);
    view.velocity << ego.velocity, 0;
    Rng rng(key.withSlot(1));
    weather_->alter(sensor, view, rng);
    pixels = rasterOf(view);
  }
  image.load = [raster = std::make_shared<const Raster>(std::move(pixels))] {
    return std::optional<Raster>(*raster);
  };
  return image;
}

RadarReturns Simulator::listenRadar(const Event& event, const RngKey& key) {
  const SensorParams& sensor = world_.scenario().sensors[event.sensor];
  RadarHook hook;
  if (weather_) hook = [&](RadarReflection& r, Rng& rng) { weather_->alter(sensor, r, rng); };
  const EgoState ego = world_.ego(event.t);
  RadarMount mount;
  mount.T_world_sensor = ego.T_world_ego * sensor.T_ego_sensor();
  const Vector2 arm =
      (mount.T_world_sensor.translation() - ego.T_world_ego.translation()).head<2>();
  mount.velocity = ego.velocity + ego.yaw_rate * Vector2(-arm.y(), arm.x());
  RadarAir air;
  if (weather_) {
    Rng rng(key);  // no phenomenon draws from it
    weather_->alter(sensor, air, rng);
  }
  caster_.setTime(event.t);
  RadarReturns returns = radarReturns(caster_, event.t, sensor.radar, mount, key, hook, air);
  targets_ += returns.returns.size();
  return returns;
}

LidarCloud Simulator::scanLidar(const Event& event, const RngKey& key) {
  const Pose3 T_ego_sensor = world_.scenario().sensors[event.sensor].T_ego_sensor();
  const auto pose_at = [&](double t) -> Pose3 { return world_.ego(t).T_world_ego * T_ego_sensor; };
  const LidarSensor& lidar = lidars_[event.sensor];
  PulseHook hook;
  if (weather_ && weather_->actsOnPulses()) {
    const SensorParams& sensor = world_.scenario().sensors[event.sensor];
    hook = [&](LidarPulse& pulse, Rng& rng) { weather_->alter(sensor, pulse, rng); };
  }
  LidarSensor::Scan scan = lidar.scan(caster_, event.t, pose_at, key, hook);
  if (weather_ && hasPointLabels(world_.scenario())) labels_ = pointLabels(scan, world_.scenario());
  if (!scanned_[event.sensor]) points_on_[event.sensor] = std::move(scan.points_on);
  scanned_[event.sensor] = true;
  ++scans_;
  points_ += scan.cloud.size();
  beams_ += lidar.beams();
  return std::move(scan.cloud);
}

}  // namespace perception
