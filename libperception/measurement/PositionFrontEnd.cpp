#include "libperception/measurement/PositionFrontEnd.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace perception {
namespace {

SensingParams positionDefaults() {
  SensingParams p;
  p.kind = "positions";
  p.modality = Modality::kLidar;
  p.clutter_per_scan = 0.1;
  p.births_per_scan = 0.03;
  return p;
}

/// "Car=car" -> its two words; empty when it is not of that form.
std::pair<std::string, std::string> splitName(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) return {};
  return {text.substr(0, equals), text.substr(equals + 1)};
}

PositionModel::Params modelParams(const ClassTable& classes, const Sensing& sensing) {
  PositionModel::Params p;
  const SensingParams& view = sensing.params();
  const int labels = static_cast<int>(sensing.labels().size());
  for (ClassId id = 0; id < classes.size(); ++id) {
    PositionModel::ClassRow row;
    row.detection = sensing.detection(id, view.range_min, 0, 1);
    for (int l = 0; l < labels; ++l) row.labels.push_back(std::exp(sensing.logLabel(l, id)));
    row.noise.setZero();  // all of it stands in R
    const ObjectClass& of = classes[id];
    row.extent = {of.length, of.width, of.length_sigma * of.length_sigma,
                  of.width_sigma * of.width_sigma};
    p.classes.push_back(std::move(row));
  }
  for (int l = 0; l < labels; ++l) p.clutter_labels.push_back(std::exp(sensing.logLabelClutter(l)));
  p.clutter_per_scan = view.clutter_per_scan;
  p.births_per_scan = view.births_per_scan;
  p.range = view.range_max;
  p.fov = view.fov;
  p.label_exponent = view.label_exponent;
  return p;
}

bool usable(const ObjectDetection::SpaceBox& box) {
  return box.bottom_centre.allFinite() &&
         std::isfinite(box.yaw + box.length + box.width + box.height) && box.length > 0 &&
         box.width > 0 && box.height > 0;
}

}  // namespace

void PositionParams::visit(ParamVisitor& v) {
  v.words("labels", labels, "our labels: the columns of the class tables");
  v.require(!labels.empty(), "labels: at least one");
  v.words("names", names, "the detector's class names and their labels: Car=car ...");
  for (const auto& n : names) {
    const auto [name, label] = splitName(n);
    v.require(std::find(labels.begin(), labels.end(), label) != labels.end(),
              "names: '" + n + "' is not NAME=LABEL with one of the labels");
  }
  v.real("min_score", min_score, {-1e9, 1e9}, "", "boxes below are dropped");
  v.real("sigma", sigma, {0.001, 1e3}, "m", "of the centre, each axis");
  v.real("range_share", range_share, {0, 1}, "", "of the distance, added to sigma in squares");
  v.boolean("sizes", sizes, "length, width, height and direction of the boxes are measured, too");
  v.angle("axis_sigma_deg", axis_sigma, {0.1, 90}, "of that direction, front and back alike");
}

PositionFrontEnd::PositionFrontEnd(PositionParams params, const ClassTable& classes,
                                   const Sensing& sensing)
    : params_(std::move(params)),
      modality_(sensing.params().modality),
      model_(std::make_shared<const PositionModel>(modelParams(classes, sensing))) {
  for (const auto& n : params_.names) {
    const auto [name, label] = splitName(n);
    label_of_[name] = sensing.labelIndex(label);
  }
}

MeasurementScan PositionFrontEnd::extract(const SensorFrame& frame) const {
  MeasurementScan scan;
  scan.sensor = frame.sensor;
  scan.modality = modality_;
  scan.frame = frame.frame;
  scan.model = model_;
  scan.state = {frame.stamp, frame.T_world_sensor(), frame.ego};
  const auto* detections = std::get_if<ObjectDetections>(&frame.data);
  if (!detections) return scan;
  const PoseUncertainty& pose = frame.ego.uncertainty;
  const Vector2 origin = scan.state.T_world_sensor.translation().head<2>();
  for (std::size_t i = 0; i < detections->objects.size(); ++i) {
    const ObjectDetection& object = detections->objects[i];
    if (object.score < params_.min_score) continue;
    const auto label = label_of_.find(object.label);
    if (!object.space_box || !usable(*object.space_box) || label == label_of_.end()) {
      ++scan.dropped;
      continue;
    }
    const ObjectDetection::SpaceBox& box = *object.space_box;
    const Vector3 place = scan.state.T_world_sensor * box.bottom_centre;
    const Vector2 sight = place.head<2>() - origin;
    if (!model_->inView(place.head<2>(),
                        scan.state)) {  // neither clutter nor objects have a density
      ++scan.dropped;
      continue;
    }
    Measurement m;
    m.z = place.head<2>();
    m.seen = 3;
    m.label = label->second;
    m.detection = static_cast<int>(i);
    // Place by the sensor, plus the vehicle's place and, across the line of sight, its heading.
    const Vector2 across(-sight.y(), sight.x());
    const double own = params_.range_share * sight.norm();
    m.R = (params_.sigma * params_.sigma + own * own + pose.sigma_xy * pose.sigma_xy) *
              Matrix2::Identity() +
          pose.sigma_yaw * pose.sigma_yaw * across * across.transpose();
    m.position = place.head<2>();
    m.position_sigma = std::sqrt(m.R.trace() / 2);
    if (params_.sizes) {
      const Vector3 axis =
          scan.state.T_world_sensor.linear() * Vector3(std::cos(box.yaw), std::sin(box.yaw), 0);
      SidesSeen sides;
      sides.yaw = std::atan2(axis.y(), axis.x());
      sides.yaw_sigma = std::hypot(params_.axis_sigma, pose.sigma_yaw);
      sides.a = box.length, sides.b = box.width;
      sides.a_complete = sides.b_complete = true;
      sides.centre = m.position;
      m.sides = sides;
      m.heading = HeadingSeen{sides.yaw, sides.yaw_sigma, 0.5};
      m.base_z = ScalarEstimate{place.z(), params_.sigma * params_.sigma};
      m.height = ScalarEstimate{box.height, params_.sigma * params_.sigma};
    }
    scan.measurements.push_back(std::move(m));
  }
  return scan;
}

std::unique_ptr<FrontEnd> makePositionFrontEnd(Config& config, const std::string& sensor_label,
                                               const ClassTable& classes) {
  const std::string section = "sensor." + sensor_label;
  const auto params = config.read<PositionParams>(section + ".positions");
  const Sensing sensing =
      Sensing::read(config, section, classes, params.labels, positionDefaults());
  return std::make_unique<PositionFrontEnd>(params, classes, sensing);
}

}  // namespace perception
