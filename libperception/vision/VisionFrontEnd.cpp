#include "libperception/vision/VisionFrontEnd.h"

#include <algorithm>
#include <cmath>

#include "libperception/measurement/PoseNoise.h"

namespace perception {
namespace {

constexpr double kNearest = 0.1;  // [m] least range: below it the object is under the camera
constexpr double kInnovationsRepeat = 0.8;  // correlation from image to image (method.md 5.6)

/// Footprints by a detector whose errors on one object repeat.
class RememberedBoxes final : public FootprintModel {
 public:
  RememberedBoxes(ClassTable classes, DetectionModel detection_model, const EvidenceMemory& memory)
      : FootprintModel(std::move(classes), std::move(detection_model)), memory_(memory) {}
  const EvidenceMemory* lookMemory() const override { return &memory_; }
  double innovationShare() const override { return EvidenceMemory::worth(kInnovationsRepeat); }

 private:
  EvidenceMemory memory_;
};

std::shared_ptr<const FootprintModel> modelOf(const EvidenceMemory& memory,
                                              const ClassTable& classes,
                                              const DetectionModel& detection_model) {
  if (memory.lasting > 0)
    return std::make_shared<const RememberedBoxes>(classes, detection_model, memory);
  return std::make_shared<const FootprintModel>(classes, detection_model);
}

/// "Car=car" -> {"Car", "car"}; empty when it is not of that form.
std::optional<std::pair<std::string, std::string>> splitName(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) return std::nullopt;
  return std::pair{text.substr(0, equals), text.substr(equals + 1)};
}

/// T_ego_camera: of the image boxes when they give it, else of the sensor.
Pose3 poseOfCamera(const SensorFrame& frame) {
  const auto* detections = std::get_if<ObjectDetections>(&frame.data);
  return detections && detections->T_ego_camera ? *detections->T_ego_camera : frame.T_ego_sensor;
}

DetectionParams cameraDefaults() {
  DetectionParams p;
  p.kind = "boxes";
  p.modality = Modality::kCamera;
  p.clutter_per_scan = 0.15;  // method.md 5.3
  p.births_per_scan = 0.01;
  p.label_exponent = 0.6;    // method.md 5.6
  p.detection_exponent = 1;  // objects without image boxes are no road users: walls, bushes
  p.fov = radians(90);
  p.range_min = 1;
  return p;
}

}  // namespace

void DetectorParams::visit(ParamVisitor& v) {
  v.words("labels", labels, "labels of the measurements: columns of the class tables");
  v.words("names", names,
          "the detector's class names and their labels: Car=car, Pedestrian=person ...");
  for (const auto& n : names) {
    const auto pair = splitName(n);
    v.require(pair && std::find(labels.begin(), labels.end(), pair->second) != labels.end(),
              "names: '" + n + "' is not NAME=LABEL with one of the labels");
  }
  v.require(!labels.empty(), "labels: at least one");
  v.real("min_score", min_score, {-1e9, 1e9}, "", "boxes below are dropped");
  v.real("score_offset", score_offset, {-1e9, 1e9}, "", "score at which the evidence is zero");
  v.table("score_offset.", label_offsets, {-1e9, 1e9}, "", "the same for one label");
  v.table("height_prior.", height_priors, {0.1, 10}, "m",
          "mean height of the objects of a label: the box's height then also gives the range");
  v.table("height_prior_sigma.", height_prior_sigmas, {0.01, 5}, "m",
          "its spread over the objects");
  for (const auto* table : {&label_offsets, &height_priors, &height_prior_sigmas}) {
    for (const auto& row : *table)
      v.require(std::find(labels.begin(), labels.end(), row.first) != labels.end(),
                row.first + ": no such label");
  }
  v.real("occluder_score", occluder_score, {-1e9, 1e9}, "",
         "least score of a box that occludes objects behind it");
  v.boolean("amodal", amodal,
            "boxes also hold what a nearer object hides, as labels of KITTI do; otherwise an edge "
            "in a nearer box is not seen");
  v.boolean("base", base, "the lower edge also measures the base height of the object");
  v.real("score_slope", score_slope, {0, 1e3}, "1/score",
         "log-odds of an object per unit of score; 0: no evidence");
  v.boolean("score_by_class", score_by_class,
            "scores are evidence against things, not of the object alone");
  v.real("memory_lasting", memory.lasting, {0, 0.999}, "",
         "share of its errors on one object that stays, missed detections included: replaces "
         "label_exponent and detection_exponent; 0: off");
  v.real("memory_kept", memory.kept, {0, 0.999}, "", "correlation of the rest at once");
  v.real("memory_time", memory.time, {1e-3, 1e9}, "s", "... which falls to 1/e after that time");
  v.angle("heading_sigma_deg", heading_sigma, {0.1, 90},
          "noise of the detector's headings, as axes");
  v.real("heading_flip", heading_flip, {0, 0.5}, "",
         "share of its headings that are reversed; 0.5: axis only");
  v.real("heading_flip_persistence", heading_flip_persistence, {0, 0.99}, "",
         "... after a reversed one of the same object");
  v.expert();
  v.real("score_limit", score_limit, {0, 50}, "", "bound of the score's log-odds");
}

VisionFrontEnd::VisionFrontEnd(DetectorParams detector, BoxGeometryParams geometry,
                               const ClassTable& classes, const DetectionModel& detection_model)
    : detector_(std::move(detector)),
      geometry_(geometry),
      classes_(classes),
      model_(modelOf(detector_.memory, classes, detection_model)) {
  for (const auto& n : detector_.names) {
    if (const auto pair = splitName(n))
      label_of_[pair->first] = detection_model.labelIndex(pair->second);
  }
  constexpr double kHeightShare = 0.1;  // of the mean: default spread
  height_prior_.resize(detection_model.labels().size());
  for (const auto& [name, mean] : detector_.height_priors) {
    double sigma = kHeightShare * mean;
    for (const auto& [other, value] : detector_.height_prior_sigmas)
      if (other == name) sigma = value;
    height_prior_[static_cast<std::size_t>(detection_model.labelIndex(name))] = {mean,
                                                                                 sigma * sigma};
  }
}

double VisionFrontEnd::logScoreRatio(double score, int label) const {
  double offset = detector_.score_offset;
  for (const auto& [name, value] : detector_.label_offsets) {
    if (model_->detection_model().labelIndex(name) == label) offset = value;
  }
  return std::clamp(detector_.score_slope * (score - offset), -detector_.score_limit,
                    detector_.score_limit);
}

std::vector<ObjectDetection::ImageBox> VisionFrontEnd::probableBoxes(
    const std::vector<ObjectDetection>& objects) const {
  std::vector<ObjectDetection::ImageBox> boxes;
  for (const ObjectDetection& object : objects) {
    const auto label = label_of_.find(object.label);
    if (!object.image_box || label == label_of_.end() || label->second < 0) continue;
    if (logScoreRatio(object.score, label->second) >= 0) boxes.push_back(*object.image_box);
  }
  return boxes;
}

std::optional<Measurement> VisionFrontEnd::measure(
    const ObjectDetection& object, const SensorFrame& frame, const CameraModel& camera,
    const Pose3& T_ego_camera, const SensorState& state, const HiddenEdges& hidden) const {
  const auto label = label_of_.find(object.label);
  if (!object.image_box || label == label_of_.end() || label->second < 0) return std::nullopt;
  auto box =
      boxOnGround(*object.image_box, camera, T_ego_camera, frame.ground, frame.ego.uncertainty,
                  geometry_, height_prior_[static_cast<std::size_t>(label->second)]);
  if (!box) return std::nullopt;
  box->left_seen &= !hidden.left;
  box->right_seen &= !hidden.right;
  if (!box->left_seen && !box->right_seen && !box->range) return std::nullopt;

  Measurement m;
  m.label = label->second;
  m.log_score_ratio = logScoreRatio(object.score, m.label);
  if (detector_.score_by_class) addClassEvidence(m);
  m.z = Vector3(box->left, box->right, box->range.value_or(0));
  m.seen = static_cast<AxisMask>((box->left_seen ? 1 << FootprintModel::kLeft : 0) |
                                 (box->right_seen ? 1 << FootprintModel::kRight : 0) |
                                 (box->range ? 1 << FootprintModel::kRange : 0));
  const double range = std::max(box->range.value_or(0.5 * geometry_.max_range), kNearest);
  const double forward = yawOf(state.T_world_sensor);
  const double bearing = forward + middleBearing(box->left, box->right);
  m.R = poseNoise({forward + box->left, range}, {forward + box->right, range}, {bearing, range},
                  frame.ego.uncertainty);
  const double sigma[FootprintModel::kAxes] = {box->left_sigma, box->right_sigma, box->range_sigma};
  for (int axis = 0; axis < FootprintModel::kAxes; ++axis) {
    m.R(axis, axis) += sigma[axis] * sigma[axis];
    if (m.seen >> axis & 1) continue;
    m.z[axis] = 0;
    m.R.row(axis).setZero(), m.R.col(axis).setZero();
  }
  m.position = state.T_world_sensor.translation().head<2>() +
               range * Vector2(std::cos(bearing), std::sin(bearing));
  m.position_sigma = box->range ? box->range_sigma : 0.5 * geometry_.max_range;
  if (object.heading && std::isfinite(*object.heading)) {
    // KITTI's alpha is the heading relative to the line of sight, clockwise from its right
    // (method.md 4.2).
    m.heading =
        MeasuredHeading{wrapAngle(bearing - *object.heading - kPi / 2),
                        std::hypot(detector_.heading_sigma, frame.ego.uncertainty.sigma_yaw),
                        detector_.heading_flip, detector_.heading_flip_persistence};
  }
  if (box->range) m.height = ScalarEstimate{box->height, box->height_sigma * box->height_sigma};
  if (box->range && detector_.base) {
    const double azimuth = yawOf(levelFrame(T_ego_camera)) + middleBearing(box->left, box->right);
    const Vector3 foot(T_ego_camera.translation().x() + range * std::cos(azimuth),
                       T_ego_camera.translation().y() + range * std::sin(azimuth), box->base);
    m.base_z =
        ScalarEstimate{(frame.ego.T_world_ego * foot).z(), box->base_sigma * box->base_sigma};
  }
  return m;
}

void VisionFrontEnd::addClassEvidence(Measurement& m) const {
  const DetectionModel& tables = model_->detection_model();
  constexpr double kOffLabel = 0.5;  // as of boxes in space (method.md 8.9)
  for (ClassId c = 0; c < classes_.size(); ++c) {
    const double share = !classes_[c].reported ? 0 : tables.labelOf(c) == m.label ? 1 : kOffLabel;
    m.log_class.push_back(tables.logLabel(m.label, c) + share * m.log_score_ratio);
  }
  m.log_clutter = tables.logLabelClutter(m.label);
}

/// Occlusion by the boxes, at their ranges; null: none occludes.
std::shared_ptr<const OcclusionMap> VisionFrontEnd::occlusion(
    const MeasurementScan& scan, const std::vector<ObjectDetection>& objects) const {
  if (detector_.occluder_score >= 1e9) return nullptr;
  constexpr std::size_t kBins = 1440;           // a quarter of a degree
  constexpr double kStep = kTwoPi / kBins / 2;  // [rad] half a bin, so that none is skipped
  const Vector2 origin = scan.state.T_world_sensor.translation().head<2>();
  const double forward = yawOf(scan.state.T_world_sensor);
  auto result = std::make_shared<OcclusionMap>(origin, kBins);
  for (const Measurement& m : scan.measurements) {
    if (m.seen != FootprintModel::kAll) continue;
    if (objects[static_cast<std::size_t>(m.detection)].score < detector_.occluder_score) continue;
    const double width = wrapAngle(m.z[FootprintModel::kLeft] - m.z[FootprintModel::kRight]);
    for (double a = 0; a <= width; a += kStep) {
      const double bearing = forward + m.z[FootprintModel::kRight] + a;
      result->add(origin +
                  m.z[FootprintModel::kRange] * Vector2(std::cos(bearing), std::sin(bearing)));
    }
  }
  return result;
}

Pose3 VisionFrontEnd::measuringPose(const SensorFrame& frame) const {
  return frame.ego.T_world_ego * levelFrame(poseOfCamera(frame));
}

void VisionFrontEnd::fill(const SensorFrame& frame, MeasurementScan& scan) const {
  const auto* detections = std::get_if<ObjectDetections>(&frame.data);
  if (!detections) return;
  const Pose3 T_ego_camera = poseOfCamera(frame);
  std::vector<ObjectDetection> objects = detections->objects;
  const auto index = joinSeam(detections->camera, geometry_.border, objects);
  std::vector<ObjectDetection::ImageBox> hiding;
  if (!detector_.amodal) hiding = probableBoxes(objects);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const ObjectDetection& object = objects[i];
    if (object.score < detector_.min_score) continue;
    HiddenEdges hidden;
    if (object.image_box) hidden = hiddenEdges(*object.image_box, hiding, geometry_.edge_sigma);
    auto m = measure(object, frame, detections->camera, T_ego_camera, scan.state, hidden);
    if (!m) {
      ++scan.dropped;
      continue;
    }
    m->detection = static_cast<int>(index[i]);
    scan.measurements.push_back(std::move(*m));
  }
  scan.occlusion = occlusion(scan, detections->objects);
}

std::unique_ptr<FrontEnd> makeVisionFrontEnd(Config& config, const std::string& sensor_label,
                                             const ClassTable& classes) {
  const std::string section = "sensor." + sensor_label;
  auto detector = config.read<DetectorParams>(section + ".detector");
  auto geometry = config.read<BoxGeometryParams>(section + ".geometry");
  const DetectionModel detection_model =
      DetectionModel::read(config, section, classes, detector.labels, cameraDefaults());
  // The measured range of an object within range_max may exceed it.
  if (detection_model.params().resolution > 0)
    geometry.max_range = 1.1 * detection_model.params().range_max;
  return std::make_unique<VisionFrontEnd>(detector, geometry, classes, detection_model);
}

}  // namespace perception
