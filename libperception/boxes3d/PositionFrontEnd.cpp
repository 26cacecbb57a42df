#include "libperception/boxes3d/PositionFrontEnd.h"

#include <algorithm>
#include <cmath>

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

/// "Car=car" -> its two words; empty when it is not of that form.
std::pair<std::string, std::string> splitName(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) return {};
  return {text.substr(0, equals), text.substr(equals + 1)};
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
    row.noise.setZero();  // all of it stands in R
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

/// The usual box's parts by their names in the INI.
struct SizePriorPart {
  const char* name;
  double SizePrior::*value;
};
constexpr SizePriorPart kSizePriorParts[] = {
    {"length", &SizePrior::length},
    {"width", &SizePrior::width},
    {"height", &SizePrior::height},
    {"base", &SizePrior::base},
    {"length_sigma", &SizePrior::length_sigma},
    {"width_sigma", &SizePrior::width_sigma},
    {"height_sigma", &SizePrior::height_sigma},
    {"base_sigma", &SizePrior::base_sigma},
};

/// "PART.LABEL" with one of the parts and one of the labels.
template <typename Parts, typename Name>
bool isPartOfLabel(const std::string& key, const Parts& parts, Name name,
                   const std::vector<std::string>& labels) {
  return std::any_of(std::begin(parts), std::end(parts), [&](const auto& part) {
    return std::any_of(labels.begin(), labels.end(), [&](const std::string& label) {
      return key == std::string(name(part)) + "." + label;
    });
  });
}

/// A label's entry of a table or the value that holds for all.
double entry(const PositionParams::Table& table, const std::string& label, double otherwise) {
  for (const auto& [name, value] : table) {
    if (name == label) return value;
  }
  return otherwise;
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
  const auto table = [&](const char* prefix, Table& rows, const char* unit, const char* text) {
    v.table(prefix, rows, {-1e9, 1e9}, unit, text);
    for (const auto& row : rows) {
      v.require(std::find(labels.begin(), labels.end(), row.first) != labels.end(),
                prefix + row.first + ": no such label");
    }
  };
  v.real("min_score", min_score, {-1e9, 1e9}, "", "boxes below are dropped");
  v.real("sigma", sigma, {0.001, 1e3}, "m", "of the center, each axis");
  v.real("range_share", range_share, {0, 1}, "", "of the distance, added to sigma");
  v.real("clutter_sigma_growth", clutter_sigma_growth, {0, 100}, "",
         "by which both grow for a box that is clutter by its score");
  v.real("score_slope", score_slope, {0, 1e3}, "1/score",
         "P(object | score) = 1 / (1 + exp(-slope (score - offset) + fade range)); 0: no evidence");
  v.real("score_offset", score_offset, {-1e9, 1e9}, "", "... score of even odds near by");
  v.real("score_fade", score_fade, {-10, 10}, "1/m", "... by which the odds fall with the range");
  v.real("score_balance", score_balance, {-50, 50}, "",
         "... log of objects / clutter where that was counted");
  table("score_slope.", label_slopes, "1/score", "the same for one label");
  table("score_offset.", label_offsets, "", "the same for one label");
  table("score_fade.", label_fades, "1/m", "the same for one label");
  table("score_balance.", label_balances, "", "the same for one label");
  v.table("weight.", weights, {-1e3, 1e3}, "",
          "... weight of FEATURE.LABEL in the same log-odds: length, width, height, base (squared "
          "misfits), slope, neighbor");
  for (const auto& row : weights)
    v.require(isPartOfLabel(
                  row.first, kBoxFeatureNames, [](auto n) { return n; }, labels),
              "weight." + row.first + ": not FEATURE.LABEL");
  v.table("usual.", usual, {-100, 100}, "m",
          "PART.LABEL: what such boxes measure: length, length_sigma, width ... base_sigma");
  for (const auto& row : usual)
    v.require(isPartOfLabel(
                  row.first, kSizePriorParts, [](const auto& p) { return p.name; }, labels) &&
                  (row.first.find("_sigma") == std::string::npos || row.second > 0),
              "usual." + row.first + ": not PART.LABEL, or a spread of 0");
  v.real("score_limit", score_limit, {0, 50}, "", "bound of the score's log evidence");
  v.words("clutter_like", clutter_like, "classes whose boxes score like clutter");
  v.real("off_label_score_weight", off_label_score_weight, {0, 1}, "",
         "of that evidence for classes that the label is not the name of");
  v.real("group_distance", group_distance, {0, 10}, "m",
         "boxes of different labels nearer than this are of one object; 0: off");
  v.real("occluder_probability", occluder_probability, {0, 1}, "",
         "P(object) from which a box hides what stands behind it; 1: no box does");
  v.boolean("sizes", sizes, "length, width, height and direction of the boxes are measured, too");
  v.angle("axis_sigma_deg", axis_sigma, {0.1, 90}, "of that direction as an axis");
  v.real("heading_flip", heading_flip, {0, 0.5}, "", "share of reversed directions");
  v.real("length_sigma", length_sigma, {0.001, 10}, "m", "of a box");
  v.real("width_sigma", width_sigma, {0.001, 10}, "m", "of a box");
  v.real("height_sigma", height_sigma, {0.001, 10}, "m", "of a box");
  v.real("base_sigma", base_sigma, {0.001, 10}, "m", "of a box's lower face");
  table("length_excess.", length_excess, "m", "by which a label's boxes are too long");
  table("width_excess.", width_excess, "m", "... too wide");
  table("height_excess.", height_excess, "m", "... too high");
}

PositionFrontEnd::PositionFrontEnd(PositionParams params, const ClassTable& classes,
                                   const DetectionModel& detection_model)
    : params_(std::move(params)),
      modality_(detection_model.params().modality),
      model_(std::make_shared<const PositionModel>(modelParams(classes, detection_model))) {
  for (const auto& n : params_.names) {
    const auto [name, label] = splitName(n);
    label_of_[name] = detection_model.labelIndex(label);
  }
  for (std::size_t l = 0; l < params_.labels.size(); ++l) {
    const std::string& name = params_.labels[l];
    Label label;
    label.evidence.slope = entry(params_.label_slopes, name, params_.score_slope);
    label.evidence.offset = entry(params_.label_offsets, name, params_.score_offset);
    label.evidence.fade = entry(params_.label_fades, name, params_.score_fade);
    for (std::size_t i = 0; i < kBoxFeatures; ++i)
      label.evidence.weights[i] =
          entry(params_.weights, std::string(kBoxFeatureNames[i]) + "." + name, 0);
    for (const SizePriorPart& part : kSizePriorParts)
      label.usual.*part.value =
          entry(params_.usual, std::string(part.name) + "." + name, label.usual.*part.value);
    label.balance = entry(params_.label_balances, name, params_.score_balance);
    label.length_excess = entry(params_.length_excess, name, 0);
    label.width_excess = entry(params_.width_excess, name, 0);
    label.height_excess = entry(params_.height_excess, name, 0);
    // A label that is no class's name ("unknown") speaks for all road users alike.
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

double PositionFrontEnd::clutterProbability(const Candidate& c) const {
  const Label& label = labels_[static_cast<std::size_t>(c.label)];
  return label.evidence.slope > 0 ? 1 / (1 + std::exp(c.log_odds)) : 0;
}

/// The faces of the boxes that surely stand there.
std::shared_ptr<const OcclusionMap> PositionFrontEnd::occlusion(
    const std::vector<std::vector<Candidate>>& groups, const SensorState& state) const {
  if (params_.occluder_probability >= 1) return nullptr;
  constexpr std::size_t kBins = 720;  // half a degree
  constexpr double kStep = 0.1;       // [m] between points of an outline: half a degree at 11 m
  auto result = std::make_shared<OcclusionMap>(state.T_world_sensor.translation().head<2>(), kBins);
  for (const auto& group : groups) {
    const ObjectDetection::SpaceBox& box = *group.front().object->space_box;
    if (1 - clutterProbability(group.front()) < params_.occluder_probability) continue;
    const Vector2 along(std::cos(box.yaw), std::sin(box.yaw)), across(-along.y(), along.x());
    const auto side = [&](const Vector2& direction, double length, const Vector2& offset) {
      for (double s = -0.5 * length; s <= 0.5 * length; s += kStep) {
        const Vector2 p = box.bottom_center.head<2>() + offset + s * direction;
        result->add((state.T_world_sensor * Vector3(p.x(), p.y(), 0)).head<2>());
      }
    };
    for (const double sign : {-0.5, 0.5}) {
      side(along, box.length, sign * box.width * across);
      side(across, box.width, sign * box.length * along);
    }
  }
  return result;
}

double PositionFrontEnd::logScoreRatio(const Candidate& c) const {
  const Label& label = labels_[static_cast<std::size_t>(c.label)];
  if (label.evidence.slope <= 0) return 0;
  return std::clamp(c.log_odds - label.balance, -params_.score_limit, params_.score_limit);
}

std::vector<std::vector<PositionFrontEnd::Candidate>> PositionFrontEnd::groups(
    const ObjectDetections& detections, const Pose3& T_ego_sensor, MeasurementScan& scan) const {
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < detections.objects.size(); ++i) {
    const ObjectDetection& object = detections.objects[i];
    if (object.score < params_.min_score) continue;
    const auto label = label_of_.find(object.label);
    const bool good =
        object.space_box && usable(*object.space_box) && label != label_of_.end() &&
        // Out of the field of view neither clutter nor objects have a density.
        model_->inView((scan.state.T_world_sensor * object.space_box->bottom_center).head<2>(),
                       scan.state);
    if (good) {
      const Label& known = labels_[static_cast<std::size_t>(label->second)];
      const double range = object.space_box->bottom_center.head<2>().norm();
      candidates.push_back(
          {&object, i, label->second,
           known.evidence.logOdds(object.score, range,
                                  boxFeatures(detections, i, known.usual, T_ego_sensor))});
    } else {
      ++scan.dropped;
    }
  }
  // The surest box of a group leads it; boxes of one label never share a group.
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
  // Place by the sensor, plus the vehicle's place and, across the line of sight, its heading.
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
  const auto found = groups(*detections, frame.T_ego_sensor, scan);
  scan.occlusion = occlusion(found, scan.state);
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
