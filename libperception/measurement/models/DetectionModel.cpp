#include "libperception/measurement/models/DetectionModel.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/LogMath.h"
#include "libperception/measurement/models/CameraResolution.h"

namespace perception {
namespace {

/// A row of [detection.MODALITY.CLASS] for a sensor with these labels: other labels are removed and
/// the rest is normalized.
ClassDetection withLabels(ClassDetection row, const std::vector<std::string>& labels) {
  const auto missing = [&](const auto& l) {
    return std::find(labels.begin(), labels.end(), l.first) == labels.end();
  };
  row.labels.erase(std::remove_if(row.labels.begin(), row.labels.end(), missing), row.labels.end());
  double sum = 0;
  for (const auto& l : row.labels) sum += l.second;
  for (auto& l : row.labels) l.second /= sum;
  return row;
}

const std::string kTablePrefix = "detection.";

std::string tableSection(Modality modality, const std::string& class_name) {
  return kTablePrefix + rowOf(modality).name + "." + class_name;
}

/// Least probability of a label (method.md 2.3).
constexpr double kLeastLabel = 0.005;

/// Probabilities in the order of `labels`: the given ones, the others sharing the remainder; sums
/// to 1.
std::vector<double> completeRow(const std::vector<std::pair<std::string, double>>& given,
                                const std::vector<std::string>& labels) {
  std::vector<double> row(labels.size(), -1);
  double sum = 0;
  std::size_t missing = labels.size();
  for (std::size_t i = 0; i < labels.size(); ++i) {
    for (const auto& [name, p] : given) {
      if (name != labels[i]) continue;
      row[i] = p;
      sum += p;
      --missing;
    }
  }
  const double share = missing > 0 ? std::max(0.0, 1 - sum) / static_cast<double>(missing) : 0;
  double total = 0;
  for (double& p : row) {
    p = std::max(p < 0 ? share : p, kLeastLabel);
    total += p;
  }
  for (double& p : row) p /= total;
  return row;
}

void checkRow(Config& config, const std::string& section,
              const std::vector<std::pair<std::string, double>>& row, const std::string& prefix,
              const std::vector<std::string>& labels) {
  double sum = 0;
  std::string known;
  for (const auto& l : labels) known += (known.empty() ? "" : ", ") + l;
  for (const auto& [name, p] : row) {
    if (std::find(labels.begin(), labels.end(), name) == labels.end()) {
      config.fault(section, prefix + name, "no label of this sensor; its labels are: " + known);
    }
    sum += p;
  }
  const bool complete = row.size() == labels.size();
  if (sum > 1.02 || (complete && sum < 0.98)) {
    config.fault(section, "", "the " + prefix + "* probabilities must sum to 1 (within .02)");
  }
}

}  // namespace

void DetectionParams::visit(ParamVisitor& v) {
  v.text("kind", kind, "front end by name: lidar, boxes, radar, positions");
  std::vector<std::string> letters;
  std::string names;
  for (const ModalityRow& row : modalities()) {
    letters.emplace_back(1, letterOf(row.letter));
    names += (names.empty() ? "" : ", ") + row.name;
  }
  int index = static_cast<int>(modalityIndex(modality));
  v.choice("modality", index, letters, names.c_str());
  modality = modalities()[static_cast<std::size_t>(index)].letter;
  v.real("clutter_per_scan", clutter_per_scan, {1e-9, 1e4}, "",
         "expected number of false measurements per scan (kappa)");
  v.choiceOf("clutter", clutter, {"fixed", "learnt"},
             "clutter_per_scan holds, or is where learning starts, by range and bearing");
  v.real("births_per_scan", births_per_scan, {1e-9, 1e4}, "",
         "expected number of new objects per scan (beta)");
  v.real("range_min", range_min, {0, 1000}, "m", "nearest objects that it sees");
  v.real("range_max", range_max, {1, 100000}, "m", "farthest objects that it sees");
  v.require(range_min < range_max, "range_min must lie below range_max");
  v.angle("fov_deg", fov, {1, 360},
          "full horizontal field of view about the sensor's forward axis");
  v.real("label_exponent", label_exponent, {0.001, 1}, "",
         "tempers labels in the class update: 1 = independent labels");
  v.real("detection_exponent", detection_exponent, {1e-3, 1}, "",
         "tempers detections and missed detections in the class update");
  v.real("noise_scale", noise_scale, {0.1, 20}, "",
         "of the standard deviations of all that its measurements say");
  v.real("corner_radius", corner_radius, {0, 0.5}, "m", "of the round corners of vehicles");
  std::vector<std::string> resolutions = cameraResolutionNames();
  resolutions.insert(resolutions.begin(), "none");
  v.choice("resolution", resolution, resolutions,
           "panoramas of Radecki et al. (kind = boxes): sets range_max, clutter_per_scan, "
           "births_per_scan and the ranges of all classes, overriding their keys");
  v.require(resolution == 0 || kind == "boxes", "resolution: of cameras, kind = boxes");
  applyResolution();
  v.table("clutter_label.", clutter_labels, {0, 1}, "",
          "P(label | clutter); labels not listed share the rest");
  v.table("precision.", precision, {0.5, 1}, "",
          "labels as in Radecki et al.: P(label | its class) = precision, else 1 - precision; a "
          "key per label");
  v.expert();
  std::vector<double> numbers;
  if (pose) {
    const Vector3 t = pose->translation();
    numbers = {t.x(),
               t.y(),
               t.z(),
               degrees(yawOf(*pose)),
               degrees(pitchOf(*pose)),
               degrees(rollOf(*pose))};
  }
  v.reals("pose", numbers, -1, {-1000, 1000}, "m, deg",
          "x, y, z, yaw, pitch, roll in the vehicle frame; overrides the log's");
  v.require(numbers.empty() || numbers.size() == 6,
            "pose: expected six numbers x, y, z [m], yaw, pitch, roll [deg]");
  if (numbers.size() == 6) {
    pose = makePose(numbers[0], numbers[1], numbers[2], radians(numbers[3]), radians(numbers[4]),
                    radians(numbers[5]));
  }
}

void DetectionParams::applyResolution() {
  if (resolution == 0) return;
  const CameraResolution& row = cameraResolutions()[static_cast<std::size_t>(resolution) - 1];
  // Births are proportional to the range, from those of the 2k panorama (method.md 5.3).
  constexpr double kBirths = 0.01, kRange = 15;  // [1/scan], [m]
  range_max = 1.2 * row.car_range;
  clutter_per_scan = row.false_per_image;
  births_per_scan = kBirths * row.car_range / kRange;
}

void ClassDetection::visit(ParamVisitor& v) {
  v.real("detection", detection, {0, 1}, "", "P(detected) in view, near, not occluded");
  v.real("full_range", full_range, {0.1, 1e5}, "m",
         "up to which P(detected) is constant; falls to 0 at last_range");
  v.real("last_range", last_range, {0.1, 1e5}, "m",
         "where P(detected) is 0; at most the sensor's range_max");
  v.real("edge_noise", edge_noise, {0, 5}, "m",
         "noise of an outline's edges beyond the measurement's: the rider of a bicycle");
  v.table("label.", labels, {0, 1}, "",
          "P(label | this class, detected); labels not listed share the rest");
}

void checkDetectionTables(Config& config, const ClassTable& classes) {
  for (const auto& section : config.sectionsWithPrefix(kTablePrefix)) {
    config.read<ClassDetection>(section);
    const auto isRow = [&](const ModalityRow& m) {
      return std::any_of(classes.classes.begin(), classes.classes.end(), [&](const ObjectClass& c) {
        return section == tableSection(m.letter, c.name);
      });
    };
    if (std::none_of(modalities().begin(), modalities().end(), isRow))
      config.fault(section, "", "not [detection.MODALITY.CLASS] of a known modality and class");
  }
}

DetectionModel DetectionModel::read(Config& config, const std::string& section,
                                    const ClassTable& classes,
                                    const std::vector<std::string>& labels,
                                    const DetectionParams& defaults) {
  const auto params = config.read<DetectionParams>(section, defaults);
  checkRow(config, section, params.clutter_labels, "clutter_label.", labels);
  for (const auto& [name, p] : params.precision) {
    if (std::find(labels.begin(), labels.end(), name) == labels.end())
      config.fault(section, "precision." + name, "no label of this sensor");
  }
  if (!params.precision.empty() && params.precision.size() != labels.size())
    config.fault(section, "", "precision.*: expected one for each label of this sensor");
  const std::string prefix = section + ".class.";
  for (const auto& s : config.sectionsWithPrefix(prefix)) {
    if (classes.find(s.substr(prefix.size())) < 0)
      config.fault(s, "", "no such class in the class table");
  }
  std::vector<ClassDetection> rows;
  for (const auto& c : classes.classes) {
    const std::string row_section = prefix + c.name;
    const auto table = config.read<ClassDetection>(tableSection(params.modality, c.name));
    const auto row = config.read<ClassDetection>(row_section, withLabels(table, labels));
    checkRow(config, row_section, row.labels, "label.", labels);
    rows.push_back(row);
  }
  return DetectionModel(params, std::move(rows), labels);
}

DetectionModel::DetectionModel(DetectionParams params, std::vector<ClassDetection> classes,
                               std::vector<std::string> labels)
    : params_(std::move(params)), classes_(std::move(classes)), labels_(std::move(labels)) {
  for (auto& c : classes_) {
    c.detection = std::max(c.detection, kLeastDetection);
    std::vector<double> row = completeRow(c.labels, labels_);
    for (double& p : row) p = std::log(p);
    log_labels_.push_back(std::move(row));
  }
  if (params_.precision.size() == labels_.size() && !labels_.empty()) applyPrecision();
  if (params_.resolution > 0) applyResolution();
  log_clutter_labels_ = completeRow(params_.clutter_labels, labels_);
  for (double& p : log_clutter_labels_) p = std::log(p);
}

void DetectionModel::applyPrecision() {
  constexpr double kLeast = 1e-3;  // [radecki2016] clamps probabilities (method.md 5.6)
  const auto table = log_labels_;
  for (std::size_t c = 0; c < table.size(); ++c) {
    const auto own = std::max_element(table[c].begin(), table[c].end()) - table[c].begin();
    for (const auto& [name, p] : params_.precision) {
      const int label = labelIndex(name);
      if (label < 0) continue;
      log_labels_[c][static_cast<std::size_t>(label)] =
          std::log(std::max(kLeast, label == own ? p : 1 - p));
    }
  }
}

// P_D falls to 0 between 0.9 and 1.1 of [radecki2016]'s range (method.md 4.2); classes that the
// detector labels "car" have the range of cars.
void DetectionModel::applyResolution() {
  const CameraResolution& resolution =
      cameraResolutions()[static_cast<std::size_t>(params_.resolution) - 1];
  for (std::size_t c = 0; c < classes_.size(); ++c) {
    const bool vehicle =
        labelIndex("car") >= 0 && labelOf(static_cast<ClassId>(c)) == labelIndex("car");
    const double range = vehicle ? resolution.car_range : resolution.person_range;
    classes_[c].full_range = 0.9 * range;
    classes_[c].last_range = 1.1 * range;
  }
}

int DetectionModel::labelOf(ClassId c) const {
  const auto& row = log_labels_[static_cast<std::size_t>(c)];
  return static_cast<int>(std::max_element(row.begin(), row.end()) - row.begin());
}

int DetectionModel::labelIndex(const std::string& name) const {
  const auto it = std::find(labels_.begin(), labels_.end(), name);
  return it == labels_.end() ? -1 : static_cast<int>(it - labels_.begin());
}

double DetectionModel::logLabel(int label, ClassId c) const {
  return log_labels_[static_cast<std::size_t>(c)][static_cast<std::size_t>(label)];
}

double DetectionModel::detection(ClassId c, double range, double bearing, double visibility) const {
  const auto& row = classes_[static_cast<std::size_t>(c)];
  if (range < params_.range_min || range >= params_.range_max) return 0;
  // P_D falls linearly to 0 at the borders of the field of view: over the last 5 % of the range and
  // the last 2 degrees.
  const double last = std::min(row.last_range, params_.range_max);
  const double full = std::min(row.full_range, 0.95 * last);
  const double by_range = std::clamp((last - range) / (last - full), 0.0, 1.0);
  double by_angle = 1;
  if (params_.fov < kTwoPi) {
    by_angle =
        std::clamp((0.5 * params_.fov - std::abs(wrapAngle(bearing))) / radians(2), 0.0, 1.0);
  }
  return row.detection * by_range * by_angle * std::clamp(visibility, 0.0, 1.0);
}

double DetectionModel::area() const {
  return 0.5 * params_.fov *
         (params_.range_max * params_.range_max - params_.range_min * params_.range_min);
}

}  // namespace perception
