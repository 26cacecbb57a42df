#include "libperception/calibration/detectors/BoxEvidenceStudy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "libperception/core/Error.h"
#include "libperception/evaluation/matching/TruthSelection.h"

namespace perception {
namespace {

constexpr double kLengthShare = 0.25, kPlace = 0.3;  // [-], [m] a box on its object
constexpr double kElsewhere =
    2;  // [m] boxes within this distance of an object of another class are excluded
constexpr double kInArea = 0.5;  // [-] of an image box: it counts as in the area, as in KITTI's kit

enum class Verdict { kObject, kClutter, kUnlabeled, kNeither };

/// Whether most of the box lies in an area of the image that the truth does not label.
bool inArea(const ObjectDetection& box, const GroundTruth::Instant& instant) {
  if (!box.image_box) return false;
  const ObjectDetection::ImageBox& b = *box.image_box;
  return std::any_of(instant.objects.begin(), instant.objects.end(), [&](const TruthObject& o) {
    if (!o.area) return false;
    const double width = std::min(b.x2, o.area->right) - std::max(b.x1, o.area->left);
    const double height = std::min(b.y2, o.area->bottom) - std::max(b.y1, o.area->top);
    return width > 0 && height > 0 && width * height >= kInArea * (b.x2 - b.x1) * (b.y2 - b.y1);
  });
}

Verdict judge(const ObjectDetection& box, const Vector2& place, const GroundTruth::Instant& instant,
              const std::vector<std::string>& classes) {
  const ClassId wanted = classOfTruth(box.label, classes);
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
  if (verdict == Verdict::kClutter && inArea(box, instant)) verdict = Verdict::kUnlabeled;
  return verdict;
}

/// A place that the truth does not label, at the box.
TruthObject unlabeledAt(const ObjectDetection::SpaceBox& box, const Pose3& T_world_sensor,
                        const GroundTruth::Instant& instant) {
  TruthObject o;
  o.frame = instant.frame;
  o.t = instant.t;
  o.type = kAreaType;
  o.position = T_world_sensor * box.bottom_center;
  o.length = box.length;
  o.width = box.width;
  o.height = box.height;
  o.ignore = true;
  return o;
}

SensorFrame frameOf(const MeasurementScan& scan, const ObjectDetections& detections) {
  SensorFrame frame;
  frame.sensor = scan.sensor;
  frame.stamp = scan.state.stamp;
  frame.ego.T_world_ego = scan.state.T_world_sensor;  // only the sensor's pose counts
  frame.data = detections;
  return frame;
}

/// Boxes of one label by log.
using ByLog = std::vector<std::vector<BoxSample>>;

std::vector<BoxSample> joined(const ByLog& logs, std::size_t without) {
  std::vector<BoxSample> all;
  for (std::size_t l = 0; l < logs.size(); ++l) {
    if (l != without) all.insert(all.end(), logs[l].begin(), logs[l].end());
  }
  return all;
}

/// Mean loss of each log under the fit to the others.
double leftOutLoss(const ByLog& logs) {
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t l = 0; l < logs.size(); ++l) {
    sum += logLoss(fitScoreOdds(joined(logs, l)), logs[l]) * static_cast<double>(logs[l].size());
    n += logs[l].size();
  }
  return n ? sum / static_cast<double>(n) : 0;
}

std::string iniLines(const std::string& label, const ScoreOdds& odds, double balance) {
  std::string lines;
  for (const auto& [key, value] : scoreKeys(label, odds, balance))
    lines += key + " = " + value + "\n";
  return lines;
}

}  // namespace

ScoreKeys scoreKeys(const std::string& label, const ScoreOdds& odds, double balance) {
  return {{"score_slope." + label, fmt::format("{:.3f}", odds.slope)},
          {"score_offset." + label, fmt::format("{:.2f}", odds.offset)},
          {"score_fade." + label, fmt::format("{:.4f}", odds.fade)},
          {"score_balance." + label, fmt::format("{:.2f}", balance)}};
}

BoxLog boxLog(const RecordedLog& log, const std::string& sensor,
              const std::map<Stamp, ObjectDetections>& detections, const GroundTruth& truth,
              ConfidenceLearner* learner) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  BoxLog out;
  std::int64_t scan = -1;
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
    if (boxes == detections.end()) continue;
    ++scan;
    const auto stated = learner ? learner->learn(frameOf(*entry.scan, boxes->second))
                                : std::vector<double>(boxes->second.objects.size(), kNone);
    if (instant == instants.end()) continue;
    const SensorState& state = entry.scan->state;
    ++out.scans;
    for (std::size_t i = 0; i < boxes->second.objects.size(); ++i) {
      const ObjectDetection& o = boxes->second.objects[i];
      if (!o.space_box) continue;
      const Vector2 place = (state.T_world_sensor * o.space_box->bottom_center).head<2>();
      const Verdict verdict = judge(o, place, *instant->second, classes);
      if (verdict == Verdict::kUnlabeled)
        out.unlabeled.push_back(unlabeledAt(*o.space_box, state.T_world_sensor, *instant->second));
      if (verdict == Verdict::kUnlabeled || verdict == Verdict::kNeither) continue;
      out.boxes.push_back(
          {o.label,
           {o.score, o.space_box->bottom_center.head<2>().norm(), verdict == Verdict::kObject},
           scan,
           stated[i]});
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
    for (const BoxWithTruth& b : log.boxes) labels.insert(b.label);
    simulated = simulated || log.simulated;
    read += (read.empty() ? "" : ", ") + log.name;
  }
  if (labels.empty()) throw DataError("no box in space of any log can be judged by its truth");
  StudyReport report;
  report.title = "Scores of a detector's 3D boxes as evidence";
  report.data = fmt::format("{}logs {}", simulated ? "simulated " : "", read);
  StudyTable table{"evidence",
                   "Mean log loss of \"this box is an object of its class\"",
                   {"label", "boxes", "objects", "log loss", "log left out"},
                   {}};
  std::string ini = fmt::format(
      "; Fitted by perception-calibrate boxes on {}.\n[sensor.{}.positions]\n", read, sensor);
  for (const std::string& label : labels) {
    ByLog by_log;
    for (const BoxLog& log : logs) {
      by_log.emplace_back();
      for (const BoxWithTruth& b : log.boxes)
        if (b.label == label) by_log.back().push_back(b.sample);
    }
    const auto all = joined(by_log, logs.size());
    const auto objects = std::count_if(all.begin(), all.end(), [](auto& s) { return s.object; });
    const ScoreOdds odds = fitScoreOdds(all);
    table.rows.push_back({label, fmt::format("{}", all.size()), fmt::format("{}", objects),
                          fmt::format("{:.4f}", logLoss(odds, all)),
                          fmt::format("{:.4f}", leftOutLoss(by_log))});
    const double n = static_cast<double>(objects), clutter = static_cast<double>(all.size()) - n;
    const auto own = names.find(label);
    ini += iniLines(own != names.end() ? own->second : label, odds,
                    std::log((n + 0.5) / (clutter + 0.5)));
  }
  report.tables.push_back(std::move(table));
  report.files.emplace_back("evidence.ini", ini);
  report.remarks.push_back("`evidence.ini` holds the section for the vehicle's INI.");
  report.remarks.push_back(
      "Boxes on objects of another class, and within 2 m of an object that they miss, are left "
      "out, and boxes of which half or more lies in an area that the truth does not label "
      "(DontCare), where both are known in the image.");
  return report;
}

}  // namespace perception
