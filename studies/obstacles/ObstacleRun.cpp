#include "studies/obstacles/ObstacleRun.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/scene/files/EventLog.h"
#include "libperception/scene/files/RunTiming.h"
#include "libperception/sensors/frames/ToObservation.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "studies/obstacles/WayTruth.h"

namespace perception {
namespace {

constexpr double kPoseRate = 50;  // [1/s]
constexpr double kLeft = 3;       // [m] from the ego origin to the shape where a drive ends

/// The nearest things of a scan along a corridor, from its beginning on.
class AlongCorridor {
 public:
  explicit AlongCorridor(const Corridor& corridor)
      : corridor_(corridor), T_ego_world_(corridor.T_world_ego.inverse()) {}

  /// [m] from the vehicle's front; infinity: not in the corridor.
  double operator()(const Vector3& place) const {
    const Vector3 p = T_ego_world_ * place;
    const ArcPlace at = arcPlace(corridor_, p.x(), p.y());
    const bool in = std::abs(at.d) <= corridor_.width / 2 && at.s >= corridor_.from;
    return in ? at.s - corridor_.from : ObstacleMoment::kNone;
  }

 private:
  const Corridor& corridor_;
  Pose3 T_ego_world_;
};

/// A return of the shape.
struct ShapeReturn {
  Vector3 place;      // [m] world
  bool told = false;  // as high as obstacles, by the front end
};

/// Judges the scene made at each scan.
class ObstacleObserver : public PipelineObserver {
 public:
  ObstacleObserver(ObstacleDrive& drive, const ObstacleShape& shape, const StopParams& stop)
      : verdict(shape.demand), drive_(drive), stop_(stop) {
    const double lidar = drive.T_ego_lidar().translation().z();
    const double height = stop.vehicle.height > 0 ? stop.vehicle.height : std::max(1.7, lidar);
    clearance_ = height + stop.clearance;
    outline_ = drive.outline(clearance_);
    first_ = drive.ego(0).stamp;
  }

  void onFrame(const SensorFrame& frame) override {
    frame_.reset();
    if (!std::holds_alternative<LidarCloud>(frame.data)) return;
    frame_ = frame;
  }

  void onScan(const MeasurementScan& scan) override {
    if (!frame_ || !scan.returns) return;
    const PlacedReturns& returns = *scan.returns;
    const auto number =
        static_cast<std::size_t>(std::lround((frame_->stamp - first_) * ObstacleDrive::kRate));
    const LidarSensor::Scan& truth = drive_.scan(number);
    const std::size_t size = std::get<LidarCloud>(frame_->data).size();
    if (size != truth.surfaces.size())
      throw Error(ExitCode::kInternal, "a simulated scan lost returns on its way to the front end");
    front_ = returns.vehicle_front, rear_ = returns.vehicle_rear, least_ = returns.height_min;
    highest_ = std::min(returns.height_max, clearance_);
    obstacles_ = obstaclesOf(returns, frame_->ego.T_world_ego, std::vector<std::uint16_t>(size));
    of_shape_.clear();
    for (std::size_t i = 0; i < returns.size(); ++i) {
      if (!drive_.isOfShape(truth, returns.source[i])) continue;
      const Vector3 place(static_cast<double>(returns.x[i]), static_cast<double>(returns.y[i]),
                          static_cast<double>(returns.z[i]));
      const auto height = static_cast<double>(returns.height[i]);
      of_shape_.push_back({frame_->ego.T_world_ego * place, height > least_ && height < highest_});
    }
    judged_ = frame_->stamp;
  }

  void onOutput(const Scene& scene) override {
    if (!judged_ || scene.stamp != *judged_ || !scene.path) return;
    const EgoState& ego = scene.ego;
    StopRule rule;
    rule.corridor =
        drivenCorridor(ego.T_world_ego, ego.velocity, ego.yaw_rate, front_, rear_, stop_);
    rule.params = stop_;
    rule.speed = ego.velocity.norm();
    ObstacleMoment moment = look(rule.corridor);
    moment.stamp = scene.stamp;
    moment.needed = stoppingDistance(rule.speed, 0, stop_);
    const double clusters = rule.within(nearestCluster(obstacles_, rule.corridor), Vector2::Zero());
    moment.stops = {scene.path->stop, clusters > 0};
    verdict.add(moment);
  }

  ObstacleVerdict verdict;

 private:
  ObstacleMoment look(const Corridor& corridor) const {
    const AlongCorridor along(corridor);
    ObstacleMoment moment;
    for (const Vector3& p : outline_) moment.gap = std::min(moment.gap, along(p));
    std::vector<double> shown, standing, told;
    for (const ShapeReturn& r : of_shape_) {
      const double s = along(r.place);
      if (!std::isfinite(s) || r.place.z() >= clearance_) continue;
      shown.push_back(s);
      if (r.place.z() <= least_ || r.place.z() >= highest_) continue;
      standing.push_back(s);
      if (r.told) told.push_back(s);
    }
    moment.shown = nearestTen(std::move(shown));
    moment.standing = nearestTen(std::move(standing));
    moment.told = nearestTen(std::move(told));
    return moment;
  }

  ObstacleDrive& drive_;
  StopParams stop_;
  double clearance_ = 0;  // [m] above the road: what hangs higher is not in the way
  double front_ = 0, rear_ = 0, least_ = 0, highest_ = 0;
  std::vector<Vector3> outline_;
  Stamp first_;
  std::optional<SensorFrame> frame_;
  std::optional<Stamp> judged_;
  LabeledObstacles obstacles_;
  std::vector<ShapeReturn> of_shape_;
};

std::shared_ptr<mrpt::obs::CObservation> observationOf(ObstacleDrive& drive, std::size_t number,
                                                       bool intensity) {
  SensorFrame frame;
  frame.sensor = drive.lidar();
  frame.stamp = drive.ego(static_cast<double>(number) / ObstacleDrive::kRate).stamp;
  frame.T_ego_sensor = drive.T_ego_lidar();
  LidarCloud cloud = drive.scan(number).cloud;
  if (!intensity) std::fill(cloud.intensity.begin(), cloud.intensity.end(), 0.0F);
  frame.data = std::move(cloud);
  return observationFromFrame(frame);
}

}  // namespace

std::string lidarInUse(const PipelineSetup& setup) {
  if (!setup.grid.enabled) throw ConfigError("[grid] enabled must be true");
  for (const PipelineSetup::Sensor& sensor : setup.sensors)
    if (sensor.isLidarInUse()) return sensor.label;
  throw ConfigError("no lidar is in use");
}

ObstacleVerdict runDrive(ObstacleDrive& drive, const ObstacleDriveParams& params,
                         const PipelineSetup& setup, bool intensity) {
  EventLog events;
  RunTiming timing;
  Pipeline pipeline(setup, events, timing);
  ObstacleObserver observer(drive, *params.shape, setup.stop);
  pipeline.observe(&observer);
  const auto drain = [&](bool flush) {
    while (pipeline.next(flush)) {
    }
    pipeline.takeWeather(), pipeline.takeLedger();
  };
  constexpr auto kPosesPerScan = static_cast<int>(kPoseRate / ObstacleDrive::kRate);
  for (std::size_t k = 0; !observer.verdict.done(); ++k) {
    const double t = static_cast<double>(k) / ObstacleDrive::kRate;
    if (params.speed * t > params.distance - kLeft) break;
    for (int i = 0; i < kPosesPerScan; ++i) {
      pipeline.add(*poseObservation(drive.ego(t + i / kPoseRate)));
      if (i == 0) pipeline.add(*observationOf(drive, k, intensity));
    }
    drain(false);
  }
  if (!observer.verdict.done()) drain(true);
  return std::move(observer.verdict);
}

}  // namespace perception
