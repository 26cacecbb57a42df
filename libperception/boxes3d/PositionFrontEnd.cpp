#include "libperception/boxes3d/PositionFrontEnd.h"

#include <algorithm>
#include <cmath>

#include "libperception/boxes3d/ConfidenceLearner.h"

namespace perception {
namespace {

DetectionParams positionDefaults() {
  DetectionParams p;
  p.kind = "positions";
  p.modality = Modality::kLidar;
  p.clutter_per_scan = 0.1;
  p.births_per_scan = 0.03;
  return p;
}

PositionModel::Params modelParams(const ClassTable& classes,
                                  const DetectionModel& detection_model) {
  PositionModel::Params p;
  const DetectionParams& view = detection_model.params();
  const int labels = static_cast<int>(detection_model.labels().size());
  for (ClassId id = 0; id < classes.size(); ++id) {
    PositionModel::ClassRow row;
    const ClassDetection& seen = detection_model.row(id);
    row.detection = seen.detection;
    row.full_range = seen.full_range;
    row.last_range = seen.last_range;
    for (int l = 0; l < labels; ++l)
      row.labels.push_back(std::exp(detection_model.logLabel(l, id)));
    row.noise.setZero();  // it is part of R
    const ObjectClass& of = classes[id];
    row.extent = {of.length, of.width, of.length_sigma * of.length_sigma,
                  of.width_sigma * of.width_sigma};
    p.classes.push_back(std::move(row));
  }
  for (int l = 0; l < labels; ++l)
    p.clutter_labels.push_back(std::exp(detection_model.logLabelClutter(l)));
  p.clutter_per_scan = view.clutter_per_scan;
  p.births_per_scan = view.births_per_scan;
  p.range = view.range_max;
  p.fov = view.fov;
  p.label_exponent = view.label_exponent;
  p.detection_exponent = view.detection_exponent;
  return p;
}

bool usable(const ObjectDetection::SpaceBox& box) {
  return box.bottom_center.allFinite() &&
         std::isfinite(box.yaw + box.length + box.width + box.height) && box.length > 0 &&
         box.width > 0 && box.height > 0;
}

/// The entry of a label in a table; 0 when it has none.
double entry(const PositionParams::Table& table, const std::string& label) {
  for (const auto& [name, value] : table) {
    if (name == label) return value;
  }
  return 0;
}

}  // namespace

ConfidenceLearner::Params learnerParams(const PositionParams& positions,
                                        const DetectionParams& view) {
  ConfidenceLearner::Params p;
  p.label_of = positions.labelOf();
  p.labels = positions.labels;
  p.fov = view.fov;
  p.clutter_per_scan = view.clutter_per_scan;
  return p;
}

PositionFrontEnd::PositionFrontEnd(PositionParams params, const ClassTable& classes,
                                   const DetectionModel& detection_model)
    : params_(std::move(params)),
      view_(detection_model.params()),
      modality_(view_.modality),
      label_of_(params_.labelOf()),
      model_(std::make_shared<const PositionModel>(modelParams(classes, detection_model))) {
  for (std::size_t l = 0; l < params_.labels.size(); ++l) {
    const std::string& name = params_.labels[l];
    Label label;
    if (params_.confidence == PositionParams::Confidence::kLearnt) {
      label.odds.slope = 1;  // scores are log-likelihood ratios by then
    } else {
      label.odds.slope = entry(params_.score_slope, name);
      label.odds.offset = entry(params_.score_offset, name);
      label.odds.fade = entry(params_.score_fade, name);
      label.balance = entry(params_.score_balance, name);
    }
    label.length_excess = entry(params_.length_excess, name);
    label.width_excess = entry(params_.width_excess, name);
    label.height_excess = entry(params_.height_excess, name);
    // A label that names no class ("unknown") supports all road users equally.
    bool names_a_class = false;
    for (ClassId c = 0; c < classes.size(); ++c)
      names_a_class = names_a_class || detection_model.labelOf(c) == static_cast<int>(l);
    for (ClassId c = 0; c < classes.size(); ++c) {
      label.log_label.push_back(detection_model.logLabel(static_cast<int>(l), c));
      const bool clutter_like =
          std::count(params_.clutter_like.begin(), params_.clutter_like.end(), classes[c].name) > 0;
      const bool own = !names_a_class || detection_model.labelOf(c) == static_cast<int>(l);
      label.score_share.push_back(clutter_like ? 0 : own ? 1 : params_.off_label_score_weight);
    }
    label.log_clutter = detection_model.logLabelClutter(static_cast<int>(l));
    labels_.push_back(std::move(label));
  }
}

std::unique_ptr<FramePreparation> PositionFrontEnd::preparation() const {
  if (params_.confidence != PositionParams::Confidence::kLearnt) return nullptr;
  return std::make_unique<ConfidenceLearner>(learnerParams(params_, view_));
}

double PositionFrontEnd::clutterProbability(const Candidate& c) const {
  const Label& label = labels_[static_cast<std::size_t>(c.label)];
  return label.odds.slope > 0 ? 1 / (1 + std::exp(c.log_odds)) : 0;
}

double PositionFrontEnd::logScoreRatio(const Candidate& c) const {
  const Label& label = labels_[static_cast<std::size_t>(c.label)];
  if (label.odds.slope <= 0) return 0;
  return std::clamp(c.log_odds - label.balance, -params_.score_limit, params_.score_limit);
}

std::vector<std::vector<PositionFrontEnd::Candidate>> PositionFrontEnd::groups(
    const ObjectDetections& detections, MeasurementScan& scan) const {
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < detections.objects.size(); ++i) {
    const ObjectDetection& object = detections.objects[i];
    if (object.score < params_.min_score) continue;
    const auto label = label_of_.find(object.label);
    const bool good =
        object.space_box && usable(*object.space_box) && label != label_of_.end() &&
        // Outside the field of view the densities are zero.
        model_->inView((scan.state.T_world_sensor * object.space_box->bottom_center).head<2>(),
                       scan.state);
    if (good) {
      const ScoreOdds& odds = labels_[static_cast<std::size_t>(label->second)].odds;
      const double range = object.space_box->bottom_center.head<2>().norm();
      candidates.push_back({&object, i, label->second, odds.logOdds(object.score, range)});
    } else {
      ++scan.dropped;
    }
  }
  // Groups start from the most probable box; boxes of one label are never grouped.
  std::stable_sort(candidates.begin(), candidates.end(), [&](const auto& a, const auto& b) {
    return logScoreRatio(a) > logScoreRatio(b);
  });
  std::vector<std::vector<Candidate>> out;
  for (const Candidate& c : candidates) {
    const auto joins = [&](const std::vector<Candidate>& group) {
      const Vector3 d =
          c.object->space_box->bottom_center - group.front().object->space_box->bottom_center;
      return d.head<2>().norm() < params_.group_distance &&
             std::none_of(group.begin(), group.end(),
                          [&](const Candidate& other) { return other.label == c.label; });
    };
    const auto group = std::find_if(out.begin(), out.end(), joins);
    group != out.end() ? group->push_back(c) : out.push_back({c});
  }
  std::sort(out.begin(), out.end(),
            [](const auto& a, const auto& b) { return a.front().index < b.front().index; });
  return out;
}

void PositionFrontEnd::addEvidence(const Candidate& c, Measurement& m) const {
  const Label& label = labels_[static_cast<std::size_t>(c.label)];
  const double ratio = logScoreRatio(c);
  for (std::size_t k = 0; k < label.log_label.size(); ++k)
    m.log_class.push_back(label.log_label[k] + label.score_share[k] * ratio);
  m.log_clutter = label.log_clutter;
}

void PositionFrontEnd::addBox(const Candidate& c, const SensorFrame& frame,
                              const SensorState& state, Measurement& m) const {
  const ObjectDetection::SpaceBox& box = *c.object->space_box;
  const Label& label = labels_[static_cast<std::size_t>(c.label)];
  const PoseUncertainty& pose = frame.ego.uncertainty;
  const Vector3 axis =
      state.T_world_sensor.linear() * Vector3(std::cos(box.yaw), std::sin(box.yaw), 0);
  PartialBox sides;
  sides.yaw = std::atan2(axis.y(), axis.x());
  sides.yaw_sigma = std::hypot(params_.axis_sigma, pose.sigma_yaw);
  sides.length = std::max(0.1, box.length - label.length_excess);
  sides.width = std::max(0.1, box.width - label.width_excess);
  sides.length_complete = sides.width_complete = true;
  sides.length_sigma = params_.length_sigma;
  sides.width_sigma = params_.width_sigma;
  sides.center = m.position;
  m.sides = sides;
  m.heading = MeasuredHeading{sides.yaw, sides.yaw_sigma, params_.heading_flip};
  const Vector3 place = state.T_world_sensor * box.bottom_center;
  m.base_z = ScalarEstimate{place.z(), params_.base_sigma * params_.base_sigma};
  m.height = ScalarEstimate{std::max(0.1, box.height - label.height_excess),
                            params_.height_sigma * params_.height_sigma};
}

Measurement PositionFrontEnd::measure(const std::vector<Candidate>& group, const SensorFrame& frame,
                                      const SensorState& state) const {
  const Candidate& first = group.front();
  const PoseUncertainty& pose = frame.ego.uncertainty;
  const Vector2 place = (state.T_world_sensor * first.object->space_box->bottom_center).head<2>();
  const Vector2 sight = place - state.T_world_sensor.translation().head<2>();
  Measurement m;
  m.z = place;
  m.seen = 3;
  m.label = first.label;
  m.detection = static_cast<int>(first.index);
  // R: noise of the sensor, of the vehicle's position and, across the line of sight, of its yaw
  // (method.md 1.3).
  const Vector2 across(-sight.y(), sight.x());
  const double own = (params_.sigma + params_.range_share * sight.norm()) *
                     (1 + params_.clutter_sigma_growth * clutterProbability(first));
  m.R = (own * own + pose.sigma_xy * pose.sigma_xy) * Matrix2::Identity() +
        pose.sigma_yaw * pose.sigma_yaw * across * across.transpose();
  m.position = place;
  m.position_sigma = std::sqrt(m.R.trace() / 2);
  addEvidence(first, m);
  if (params_.sizes) addBox(first, frame, state, m);
  return m;
}

void PositionFrontEnd::fill(const SensorFrame& frame, MeasurementScan& scan) const {
  const auto* detections = std::get_if<ObjectDetections>(&frame.data);
  if (!detections) return;
  const auto found = groups(*detections, scan);
  for (const auto& group : found) scan.measurements.push_back(measure(group, frame, scan.state));
}

std::unique_ptr<FrontEnd> makePositionFrontEnd(Config& config, const std::string& sensor_label,
                                               const ClassTable& classes) {
  const std::string section = "sensor." + sensor_label;
  const auto params = config.read<PositionParams>(section + ".positions");
  for (const auto& name : params.clutter_like) {
    if (classes.find(name) < 0 && name != "static-other")
      config.fault(section + ".positions", "clutter_like", "no such class '" + name + "'");
  }
  const DetectionModel detection_model =
      DetectionModel::read(config, section, classes, params.labels, positionDefaults());
  return std::make_unique<PositionFrontEnd>(params, classes, detection_model);
}

}  // namespace perception
