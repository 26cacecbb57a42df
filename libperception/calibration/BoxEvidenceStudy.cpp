#include "libperception/calibration/BoxEvidenceStudy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "libperception/core/Error.h"
#include "libperception/evaluation/TruthSelection.h"

namespace perception {
namespace {

constexpr double kLengthShare = 0.25, kPlace = 0.3;  // [-], [m] a box on its object
constexpr double kElsewhere = 2;      // [m] nearer to an object of another class a box is neither
constexpr double kLeastSigma = 0.02;  // [m]

enum class Verdict { kObject, kClutter, kNeither };

Verdict judge(const std::string& label, const Vector2& place, const GroundTruth::Instant& instant,
              const std::vector<std::string>& classes) {
  const ClassId wanted = classOfTruth(label, classes);
  Verdict verdict = Verdict::kClutter;
  for (const TruthObject& o : instant.objects) {
    if (!std::isfinite(o.length) || !o.position.allFinite()) continue;  // an area of the image
    const double distance = (o.position.head<2>() - place).norm();
    if (classOfTruth(o.type, classes) == wanted) {
      if (distance < kLengthShare * o.length + kPlace) return Verdict::kObject;
      if (distance < kElsewhere) verdict = Verdict::kNeither;  // a bad box of an object
    } else if (distance < kElsewhere) {
      verdict = Verdict::kNeither;
    }
  }
  return verdict;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Median and robust spread of a part of the boxes that are on objects.
template <typename Part>
std::pair<double, double> priorOf(const std::vector<const JudgedBox*>& boxes, Part part) {
  constexpr double kNormal = 1.4826;  // spread of a Gaussian per median deviation
  std::vector<double> values;
  for (const JudgedBox* b : boxes)
    if (b->object) values.push_back(part(*b));
  const double middle = median(values);
  for (double& v : values) v = std::abs(v - middle);
  return {middle, std::max(kLeastSigma, kNormal * median(values))};
}

SizePrior sizePrior(const std::vector<const JudgedBox*>& boxes) {
  SizePrior u;
  std::tie(u.length, u.length_sigma) = priorOf(boxes, [](const auto& b) { return b.box.length; });
  std::tie(u.width, u.width_sigma) = priorOf(boxes, [](const auto& b) { return b.box.width; });
  std::tie(u.height, u.height_sigma) = priorOf(boxes, [](const auto& b) { return b.box.height; });
  std::tie(u.base, u.base_sigma) = priorOf(boxes, [](const auto& b) { return b.base; });
  return u;
}

std::vector<BoxSample> samplesOf(const std::vector<const JudgedBox*>& boxes,
                                 const SizePrior& usual) {
  std::vector<BoxSample> samples;
  for (const JudgedBox* b : boxes) {
    BoxFeatureVector f = boxShape(b->box, b->base, usual);
    f[static_cast<std::size_t>(BoxFeature::kSlope)] = b->slope;
    f[static_cast<std::size_t>(BoxFeature::kNeighbor)] = b->neighbor;
    samples.push_back({b->score, b->range, f, b->object});
  }
  return samples;
}

/// Boxes of one label by log.
using ByLog = std::vector<std::vector<const JudgedBox*>>;

std::vector<const JudgedBox*> joined(const ByLog& logs, std::size_t without) {
  std::vector<const JudgedBox*> all;
  for (std::size_t l = 0; l < logs.size(); ++l) {
    if (l != without) all.insert(all.end(), logs[l].begin(), logs[l].end());
  }
  return all;
}

/// Mean loss of each log under what was fitted on the others.
double leftOutLoss(const ByLog& logs, bool with_features) {
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t l = 0; l < logs.size(); ++l) {
    const auto others = joined(logs, l);
    const SizePrior usual = sizePrior(others);
    const BoxEvidence e = fitBoxEvidence(samplesOf(others, usual), with_features);
    sum += logLoss(e, samplesOf(logs[l], usual)) * static_cast<double>(logs[l].size());
    n += logs[l].size();
  }
  return n ? sum / static_cast<double>(n) : 0;
}

std::string iniLines(const std::string& label, const BoxEvidence& e, const SizePrior& u,
                     double balance, bool features) {
  std::string text = fmt::format(
      "score_slope.{0} = {1:.3f}\nscore_offset.{0} = {2:.2f}\nscore_fade.{0} = {3:.4f}\n"
      "score_balance.{0} = {4:.2f}\n",
      label, e.slope, e.offset, e.fade, balance);
  if (!features) return text;
  const std::pair<const char*, double> parts[] = {
      {"length", u.length}, {"length_sigma", u.length_sigma},
      {"width", u.width},   {"width_sigma", u.width_sigma},
      {"height", u.height}, {"height_sigma", u.height_sigma},
      {"base", u.base},     {"base_sigma", u.base_sigma}};
  for (const auto& [name, value] : parts)
    text += fmt::format("usual.{}.{} = {:.2f}\n", name, label, value);
  for (std::size_t i = 0; i < kBoxFeatures; ++i)
    text += fmt::format("weight.{}.{} = {:.3f}\n", kBoxFeatureNames[i], label, e.weights[i]);
  return text;
}

}  // namespace

BoxLog boxLog(const RecordedLog& log, const std::string& sensor,
              const std::map<Stamp, ObjectDetections>& detections, const GroundTruth& truth) {
  BoxLog out;
  out.name = log.name;
  out.simulated = log.simulated;
  std::vector<std::string> classes;
  for (const ObjectClass& c : log.model.classes.classes) classes.push_back(c.name);
  std::map<std::int64_t, const GroundTruth::Instant*> instants;
  for (const auto& instant : truth.instants) instants[instant.frame] = &instant;
  for (const RecordedLog::Entry& entry : log.entries) {
    if (entry.kind != RecordedLog::Entry::kScan || entry.scan->sensor != sensor) continue;
    const auto boxes = detections.find(entry.scan->state.stamp);
    const auto instant = instants.find(entry.scan->frame);
    if (boxes == detections.end() || instant == instants.end()) continue;
    const SensorState& state = entry.scan->state;
    const Pose3 T_ego_sensor = state.ego.T_world_ego.inverse() * state.T_world_sensor;
    for (std::size_t i = 0; i < boxes->second.objects.size(); ++i) {
      const ObjectDetection& o = boxes->second.objects[i];
      if (!o.space_box) continue;
      const Vector2 place = (state.T_world_sensor * o.space_box->bottom_center).head<2>();
      const Verdict verdict = judge(o.label, place, *instant->second, classes);
      if (verdict == Verdict::kNeither) continue;
      const BoxFeatureVector f = boxFeatures(boxes->second, i, {}, T_ego_sensor);
      out.boxes.push_back({o.label, o.score, o.space_box->bottom_center.head<2>().norm(),
                           *o.space_box, (T_ego_sensor * o.space_box->bottom_center).z(),
                           f[static_cast<std::size_t>(BoxFeature::kNeighbor)],
                           f[static_cast<std::size_t>(BoxFeature::kSlope)],
                           verdict == Verdict::kObject});
    }
  }
  return out;
}

StudyReport boxEvidenceStudy(const std::string& sensor, const std::vector<BoxLog>& logs,
                             const std::map<std::string, std::string>& names) {
  std::set<std::string> labels;
  bool simulated = false;
  std::string read;
  for (const BoxLog& log : logs) {
    for (const JudgedBox& b : log.boxes) labels.insert(b.label);
    simulated = simulated || log.simulated;
    read += (read.empty() ? "" : ", ") + log.name;
  }
  if (labels.empty()) throw DataError("no box in space of any log can be judged by its truth");
  StudyReport report;
  report.title = "What a detector's boxes say of objects";
  report.data = fmt::format("{}logs {}", simulated ? "simulated " : "", read);
  StudyTable table{"evidence",
                   "Mean log loss of \"this box is an object of its class\"",
                   {"label", "boxes", "objects", "score", "score, log left out", "with features",
                    "with features, log left out", "taken"},
                   {}};
  std::string ini = fmt::format(
      "; Fitted by perception-study boxes on {}.\n[sensor.{}.positions]\n", read, sensor);
  for (const std::string& label : labels) {
    ByLog by_log;
    for (const BoxLog& log : logs) {
      by_log.emplace_back();
      for (const JudgedBox& b : log.boxes)
        if (b.label == label) by_log.back().push_back(&b);
    }
    const auto all = joined(by_log, logs.size());
    const SizePrior usual = sizePrior(all);
    const auto samples = samplesOf(all, usual);
    const auto objects = std::count_if(all.begin(), all.end(), [](auto* b) { return b->object; });
    const BoxEvidence plain = fitBoxEvidence(samples, false), full = fitBoxEvidence(samples, true);
    const double plain_out = leftOutLoss(by_log, false), full_out = leftOutLoss(by_log, true);
    const bool taken = full_out < plain_out;
    table.rows.push_back({label, fmt::format("{}", all.size()), fmt::format("{}", objects),
                          fmt::format("{:.4f}", logLoss(plain, samples)),
                          fmt::format("{:.4f}", plain_out),
                          fmt::format("{:.4f}", logLoss(full, samples)),
                          fmt::format("{:.4f}", full_out), taken ? "features" : "score"});
    const double n = static_cast<double>(objects), clutter = static_cast<double>(all.size()) - n;
    const auto own = names.find(label);
    ini += iniLines(own != names.end() ? own->second : label, taken ? full : plain, usual,
                    std::log((n + 0.5) / (clutter + 0.5)), taken);
  }
  report.tables.push_back(std::move(table));
  report.files.emplace_back("evidence.ini", ini);
  report.remarks.push_back("`evidence.ini` holds the section for the vehicle's INI.");
  report.remarks.push_back(
      "Boxes on objects of another class, and within 2 m of an object that they miss, are left "
      "out; areas that the truth does not label (DontCare) cannot be told from clutter here.");
  return report;
}

}  // namespace perception
