#include "libperception/pictures/SnapshotSensors.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "gui-offscreen/views/SensorView.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/images/CameraImages.h"
#include "libperception/sensors/observations/Conversions.h"

namespace perception {
namespace {

constexpr double kLastScan = 0.5;  // [s] after which returns are too old to be drawn
constexpr double kLastImage = 1;   // [s]
constexpr double kLookAhead = 3;   // [s] of log in which every sensor has had a frame

bool hasImageBoxes(const ObjectDetections& detections) {
  if (detections.camera.width <= 0) return false;
  return detections.objects.empty() || detections.objects.front().image_box.has_value();
}

// The camera of a frame, if it has one; an image is loaded if the log does not have its size.
std::optional<CameraModel> cameraOf(const SensorFrame& frame) {
  if (const auto* boxes = std::get_if<ObjectDetections>(&frame.data)) {
    if (hasImageBoxes(*boxes)) return boxes->camera;
  }
  const auto* image = std::get_if<CameraImage>(&frame.data);
  if (!image) return std::nullopt;
  CameraModel camera = image->camera;
  if (camera.width <= 0 || camera.height <= 0) {
    const auto raster = image->load ? image->load() : std::nullopt;
    if (!raster) return std::nullopt;
    camera.width = raster->width;
    camera.height = raster->height;
  }
  if (!(camera.fx > 0) || !(camera.fy > 0)) return panoramaModel(camera.width, camera.height);
  return camera;
}

// The box in the pixels of an image; panoramas of two sizes differ by their scale alone. Empty for
// two cameras that have nothing in common.
std::optional<ObjectDetection::ImageBox> boxIn(const CameraModel& image,
                                               const ObjectDetection::ImageBox& box,
                                               const CameraModel& detector) {
  if (detector.width == image.width) return box;
  constexpr auto kSphere = CameraModel::Projection::kEquirectangular;
  if (image.projection != kSphere || detector.projection != kSphere) return std::nullopt;
  const double scale = static_cast<double>(image.width) / detector.width;
  const auto x = [&](double u) { return image.cx + scale * (u - detector.cx); };
  const auto y = [&](double v) { return image.cy + scale * (v - detector.cy); };
  return ObjectDetection::ImageBox{x(box.x1), y(box.y1), x(box.x2), y(box.y2)};
}

// The seen sides as a rectangle on the ground.
std::vector<Vector3> outlineOf(const PartialBox& sides, double z) {
  const auto corners =
      boxCorners({sides.center.x(), sides.center.y(), z}, sides.yaw, sides.length, sides.width, 0);
  return {corners.begin(), corners.begin() + 4};
}

}  // namespace

void SnapshotSensorParams::read(Config& config, bool site) {
  if (!site) {
    ground = config.read<GroundParams>("ground");
    weather = WeatherParams::read(config);
    grid = config.read<GridParams>("grid");
    stop = config.read<StopParams>("grid.stop");
    stop.vehicle = config.read<VehicleParams>("vehicle");
    return;
  }
  PipelineSetup setup = PipelineSetup::read(config);
  ground = setup.ground;
  weather = setup.weather;
  grid = setup.grid;
  stop = setup.stop;
  sensors = std::move(setup.sensors);
}

SnapshotSensors::SnapshotSensors(const std::string& log, const TrackedRun& run,
                                 SnapshotSensorParams params)
    : log_(log),
      reader_(log),
      run_(run),
      params_(std::move(params)),
      safety_(params_.grid, params_.stop) {
  lookAhead(log);
}

// Prefers a camera with images to one with boxes only.
void SnapshotSensors::lookAhead(const std::string& log) {
  RawlogReader reader(log);
  std::optional<Stamp> first;
  std::string chosen = params_.camera;
  while (const auto observation = reader.next()) {
    const auto frame = frameOf(*observation);
    if (!frame) continue;
    if (!first) first = frame->stamp;
    const bool late = frame->stamp - *first > kLookAhead;
    if (late && (params_.camera.empty() || layers_.camera)) break;
    layers_.lidar = layers_.lidar || std::holds_alternative<LidarCloud>(frame->data);
    layers_.radar = layers_.radar || std::holds_alternative<RadarReturns>(frame->data);
    if (const auto* boxes = std::get_if<ObjectDetections>(&frame->data)) {
      layers_.detector_boxes = layers_.detector_boxes || hasImageBoxes(*boxes);
    }
    if (const auto* cloud = std::get_if<LidarCloud>(&frame->data)) {
      layers_.trust = layers_.trust || !cloud->trust.empty();
    }
    const bool image = std::holds_alternative<CameraImage>(frame->data);
    const bool wanted = params_.camera.empty() ? !layers_.camera || (image && !images_)
                                               : frame->sensor == params_.camera;
    if (!wanted) continue;
    if (const auto camera = cameraOf(*frame)) {
      layers_.camera = camera;
      images_ = images_ || image;
      chosen = frame->sensor;
    }
  }
  params_.camera = chosen;
  layers_.trust = layers_.trust || (layers_.lidar && params_.weather.filter != "off");
  layers_.measurements = !params_.sensors.empty() && params_.measurements;
}

std::optional<SensorFrame> SnapshotSensors::frameOf(
    const mrpt::obs::CObservation& observation) const {
  return frameFromObservation(observation, nullptr, imagesBeside(log_));
}

double SnapshotSensors::past() const { return std::max(params_.memory, kLastImage); }

void SnapshotSensors::advanceTo(Stamp stamp) {
  now_ = stamp;
  while (true) {
    if (!next_) next_ = reader_.next();
    if (!next_) return;
    if (isSensorData(*next_)) {
      const auto at = toStamp(next_->timestamp);
      if (at && *at > stamp) return;
      if (at && stamp - *at <= past()) {
        if (auto frame = frameOf(*next_)) take(std::move(*frame));
      }
    }
    next_.reset();
  }
}

const PipelineSetup::Sensor* SnapshotSensors::sensorOf(const std::string& label) const {
  for (const auto& sensor : params_.sensors) {
    if (sensor.label == label || sensor.scan.merges(label)) return &sensor;
  }
  return nullptr;
}

// Of the site's lidar of that label, else the defaults.
SnapshotSensors::LidarSettings SnapshotSensors::settingsOf(const SensorFrame& frame) const {
  const auto* sensor = sensorOf(frame.sensor);
  const auto* lidar =
      sensor ? dynamic_cast<const LidarFrontEnd*>(sensor->front_end.get()) : nullptr;
  if (!lidar) return {};
  return {lidar->pointsFor(frame), lidar->params().surface, lidar->params().obstacles};
}

void SnapshotSensors::take(SensorFrame frame) {
  const auto ego = egoAt(run_, frame.stamp);
  if (!ego) return;
  frame.ego = *ego;
  if (const auto* sensor = sensorOf(frame.sensor)) {
    if (sensor->params.pose) frame.T_ego_sensor = *sensor->params.pose;
  }
  if (std::holds_alternative<LidarCloud>(frame.data)) takeLidar(frame);
  frame.ground = ground_;
  ++frames_;
  std::string label = frame.sensor;
  last_.insert_or_assign(std::move(label), std::move(frame));
}

void SnapshotSensors::takeLidar(SensorFrame& frame) {
  const auto seed = lidars_.size();
  Lidar& lidar = lidars_
                     .try_emplace(frame.sensor, Lidar{GroundEstimator(params_.ground, seed),
                                                      makePointFilter(params_.weather),
                                                      {},
                                                      {}})
                     .first->second;
  ground_ = frame.ground = lidar.ground.update(frame);
  if (lidar.weather) {
    lidar.weather->apply(frame);
    lidar.air.add(lidar.weather->census(frame), frame.stamp);
    frame.causes.weather = lidar.air.state().notClear();
    frame.causes.clouds = lidar.air.clouds(frame.T_world_sensor(), frame.causes.weather);
  }
  const LidarSettings settings = settingsOf(frame);
  EgoPoints points = usablePoints(frame, settings.points);
  std::vector<float> heights;
  GroundSurface(frame.ground, points, settings.surface, &heights);
  const PlacedReturns returns =
      placedReturns(std::move(points), std::move(heights), settings.points, settings.obstacles);
  const std::vector<float>& trust = std::get<LidarCloud>(frame.data).trust;
  lidar.points.clear();
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const Vector3 place = frame.ego.T_world_ego * Vector3(returns.x[i], returns.y[i], returns.z[i]);
    lidar.points.push_back(
        {place, returns.height[i], trust.empty() ? 1.0F : trust[returns.source[i]]});
  }
  safety_.add(frame, returns);
  ++scans_;
}

void SnapshotSensors::addMeasurements(const SensorFrame& frame, SceneView& view) const {
  if (!layers_.measurements) return;
  const auto* sensor = sensorOf(frame.sensor);
  if (!sensor || !sensor->active || !sensor->front_end) return;
  const MeasurementScan scan = sensor->front_end->extract(frame);
  const double z = view.scene.ego.T_world_ego.translation().z();
  for (const Measurement& m : scan.measurements) {
    ViewMeasurement shown{scan.modality, {m.position.x(), m.position.y(), z}, {}};
    if (m.sides) shown.outline = outlineOf(*m.sides, z);
    view.measurements.push_back(std::move(shown));
  }
}

void SnapshotSensors::addImage(SceneView& view) {
  if (!layers_.camera) return;
  const auto shown = last_.find(params_.camera);
  if (shown == last_.end() || now_ - shown->second.stamp > kLastImage) return;
  const SensorFrame& frame = shown->second;
  ViewImage image;
  image.sensor = frame.sensor;
  image.camera = *layers_.camera;
  image.T_world_camera = frame.T_world_sensor();
  image.age = now_ - frame.stamp;
  if (const auto* source = std::get_if<CameraImage>(&frame.data)) {
    if (const auto raster = source->load ? source->load() : std::nullopt) {
      image.picture = pictureOf(*raster);
    } else {
      image.missing = true;
      if (missing_image_.empty()) missing_image_ = source->source;
    }
  }
  // Boxes of any detector that worked on images of this size, or on panoramas if it is one.
  for (const auto& [label, other] : last_) {
    const auto* found = std::get_if<ObjectDetections>(&other.data);
    if (!found || !hasImageBoxes(*found) || now_ - other.stamp > kLastScan) continue;
    if (label == frame.sensor && found->T_ego_camera) {
      image.T_world_camera = frame.ego.T_world_ego * *found->T_ego_camera;
    }
    for (const ObjectDetection& object : found->objects) {
      const auto box =
          object.image_box ? boxIn(image.camera, *object.image_box, found->camera) : std::nullopt;
      if (box) image.boxes.push_back({*box, object.label});
    }
  }
  view.image = std::move(image);
}

void SnapshotSensors::fill(SceneView& view) {
  view.layers = layers_;
  for (const auto& [label, frame] : last_) {
    if (now_ - frame.stamp > kLastScan) continue;
    const auto lidar = lidars_.find(label);
    if (lidar != lidars_.end()) {
      view.points.insert(view.points.end(), lidar->second.points.begin(),
                         lidar->second.points.end());
    }
    if (std::holds_alternative<RadarReturns>(frame.data)) addRadar(frame, view);
    addMeasurements(frame, view);
  }
  addImage(view);
  view.occupied = safety_.grid().occupiedCells();
  const PathAhead path = safety_.pathAhead(view.scene.ego);
  if (!path.known) return;
  view.corridor = path.corridor;
  view.free = path.free;
  // The run also knew shapes, wakes and the weather of earlier scans: what it said is shown.
  if (const auto& said = view.scene.path)
    view.free.distance = said->distance, view.free.seen = said->seen,
    view.free.blocked = said->blocked;
}

}  // namespace perception
