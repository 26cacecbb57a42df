#include "libperception/calibration/detectors/ConfidenceStudy.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libperception/calibration/detectors/ReliabilityCounts.h"
#include "libperception/core/Error.h"
#include "libperception/evaluation/metrics/Metrics.h"

namespace perception {
namespace {

constexpr double kLeast = 0.05, kStep = 0.05;
constexpr std::size_t kThresholds = 19;
constexpr double kFewest = 0.5;  // objects of a label in all frames, for its logarithm

using Curve = std::array<ClearFigures, kThresholds>;

double thresholdOf(std::size_t k) { return kLeast + kStep * static_cast<double>(k); }

/// Boxes of each label of the INI by log; `scans`: of each log.
struct Samples {
  std::map<std::string, std::vector<std::vector<BoxSample>>> boxes;
  std::vector<std::size_t> scans;
};

Samples samplesOf(const ConfidenceInput& input) {
  Samples out;
  for (std::size_t l = 0; l < input.logs.size(); ++l) {
    out.scans.push_back(input.logs[l].scans);
    for (const BoxWithTruth& b : input.logs[l].boxes) {
      const auto name = input.names.find(b.label);
      auto& by_log = out.boxes[name != input.names.end() ? name->second : b.label];
      by_log.resize(input.logs.size());
      by_log[l].push_back(b.sample);
    }
  }
  return out;
}

struct Fit {
  std::map<std::string, ScoreOdds> odds;
  ScoreKeys keys;
};

/// Of all logs but one; of all if there is only one, or none of that number.
Fit fitOf(const Samples& samples, std::size_t without, double clutter_per_scan) {
  Fit fit;
  if (samples.scans.size() == 1) without = 1;
  for (const auto& [label, by_log] : samples.boxes) {
    std::vector<BoxSample> all;
    std::size_t scans = 0;
    for (std::size_t l = 0; l < by_log.size(); ++l) {
      if (l == without) continue;
      all.insert(all.end(), by_log[l].begin(), by_log[l].end());
      scans += samples.scans[l];
    }
    const auto objects = std::count_if(all.begin(), all.end(), [](auto& s) { return s.object; });
    const double a_scan = std::max(kFewest, static_cast<double>(objects)) /
                          static_cast<double>(std::max<std::size_t>(scans, 1));
    fit.odds[label] = fitScoreOdds(all);
    for (auto& key : scoreKeys(label, fit.odds[label], std::log(a_scan / clutter_per_scan)))
      fit.keys.push_back(std::move(key));
  }
  return fit;
}

/// The truth of a log with the places that it does not label.
GroundTruth truthOf(const ConfidenceInput& input, std::size_t log) {
  GroundTruth truth = input.truths[log];
  std::map<std::int64_t, GroundTruth::Instant*> instants;
  for (auto& instant : truth.instants) instants[instant.frame] = &instant;
  for (const TruthObject& place : input.logs[log].unlabeled) {
    const auto instant = instants.find(place.frame);
    if (instant != instants.end()) instant->second->objects.push_back(place);
  }
  return truth;
}

Curve curveOf(const ConfidenceInput& input, std::size_t log, const ScoreKeys& keys) {
  TrackedRun run = input.track(log, keys);
  const GroundTruth truth = truthOf(input, log);
  Curve curve;
  for (std::size_t k = 0; k < kThresholds; ++k) {
    for (Scene& scene : run.scenes) {
      scene.objects.erase(
          std::remove_if(scene.objects.begin(), scene.objects.end(),
                         [&](const SceneObject& o) { return o.existence < thresholdOf(k); }),
          scene.objects.end());
    }
    curve[k] = clearFigures(evaluate(run, truth, input.evaluation));
  }
  return curve;
}

/// Pooled over all logs but one.
Curve pooledOf(const std::vector<Curve>& curves, std::size_t without) {
  Curve sum;
  for (std::size_t k = 0; k < kThresholds; ++k) {
    for (std::size_t l = 0; l < curves.size(); ++l) {
      if (l == without) continue;
      sum[k].truth += curves[l][k].truth;
      sum[k].misses += curves[l][k].misses;
      sum[k].false_objects += curves[l][k].false_objects;
      sum[k].id_switches += curves[l][k].id_switches;
    }
    sum[k].setMota();
  }
  return sum;
}

std::size_t bestOf(const Curve& curve) {
  std::size_t best = 0;
  for (std::size_t k = 1; k < kThresholds; ++k)
    if (curve[k].mota.value_or(-1e9) > curve[best].mota.value_or(-1e9)) best = k;
  return best;
}

std::vector<std::string> rowOf(const std::string& log, std::size_t threshold,
                               const ClearFigures& f) {
  return {log,
          fmt::format("{:.2f}", thresholdOf(threshold)),
          f.mota ? fmt::format("{:.2f}", 100 * *f.mota) : "n/a",
          fmt::format("{}", f.truth),
          fmt::format("{}", f.misses),
          fmt::format("{}", f.false_objects),
          fmt::format("{}", f.id_switches)};
}

/// Stated probability against the share of objects, each log's boxes by what the others taught.
void addReliability(const std::string& label, const std::vector<std::vector<BoxSample>>& by_log,
                    const std::vector<Fit>& left_out, StudyTable& table) {
  ReliabilityCounts counts;
  for (std::size_t l = 0; l < by_log.size(); ++l) {
    for (const BoxSample& s : by_log[l])
      counts.add(1 / (1 + std::exp(-left_out[l].odds.at(label).logOdds(s.score, s.range))),
                 s.object);
  }
  for (const auto& [boxes, stated, objects] : counts.curve())
    table.rows.push_back({label, fmt::format("{:.0f}", boxes), fmt::format("{:.3f}", stated),
                          fmt::format("{:.3f}", objects)});
  table.rows.push_back({label + ": calibration error", fmt::format("{:.0f}", counts.count()),
                        fmt::format("{:.3f}", counts.error()), ""});
}

std::string iniOf(const ConfidenceInput& input, const std::string& include, const Fit& fit,
                  double threshold, const std::string& logs) {
  std::string ini = fmt::format(
      "; Fitted by perception-calibrate confidence on {0}.\ninclude = {1}\n[scene]\nmin_existence "
      "= "
      "{2:.2f}\nroad_user_from = {2:.2f}\n[sensor.{3}]\nclutter_per_scan = {4:g}   ; that of the "
      "fit\n[sensor.{3}.positions]\nconfidence = fitted\n",
      logs, include, threshold, input.sensor, input.clutter_per_scan);
  for (const auto& [key, value] : fit.keys) ini += key + " = " + value + "\n";
  return ini;
}

}  // namespace

double leastExistence() { return kLeast; }

StudyReport confidenceStudy(const ConfidenceInput& input, const std::string& include) {
  const Samples samples = samplesOf(input);
  if (samples.boxes.empty())
    throw DataError("no box in space of any log can be judged by its truth");
  const std::size_t n = input.logs.size();
  std::vector<Fit> left_out;
  for (std::size_t l = 0; l < n; ++l) left_out.push_back(fitOf(samples, l, input.clutter_per_scan));
  std::vector<Curve> curves(n);
  tbb::parallel_for(std::size_t{0}, n,
                    [&](std::size_t l) { curves[l] = curveOf(input, l, left_out[l].keys); });

  const Curve pooled = pooledOf(curves, n);
  const std::size_t best = bestOf(pooled);
  std::string names;
  bool simulated = false;
  StudyTable by_log{
      "logs",
      "Each log with odds of scores and output threshold that the others taught",
      {"log", "min_existence", "MOTA", "objects x instants", "missed", "false", "id switches"},
      {}};
  StudyTable by_threshold = {"thresholds", "All logs by output threshold", by_log.columns, {}};
  StudyTable reliability{"reliability",
                         "Probability that a box is an object, by what the other logs taught",
                         {"label", "boxes", "stated", "objects"},
                         {}};
  for (std::size_t l = 0; l < n; ++l) {
    names += (l ? ", " : "") + input.logs[l].name;
    simulated = simulated || input.logs[l].simulated;
    const std::size_t k = n > 1 ? bestOf(pooledOf(curves, l)) : best;
    by_log.rows.push_back(rowOf(input.logs[l].name, k, curves[l][k]));
  }
  for (std::size_t k = 0; k < kThresholds; ++k)
    by_threshold.rows.push_back(rowOf("all", k, pooled[k]));
  for (const auto& [label, boxes] : samples.boxes)
    addReliability(label, boxes, left_out, reliability);

  StudyReport report;
  report.title = "What a detector's scores are worth, and from which existence on to output";
  report.data = fmt::format("{}logs {}", simulated ? "simulated " : "", names);
  report.tables = {std::move(by_log), std::move(by_threshold), std::move(reliability)};
  report.files.emplace_back(
      "confidence.ini",
      iniOf(input, include, fitOf(samples, n, input.clutter_per_scan), thresholdOf(best), names));
  report.remarks = {
      fmt::format("`confidence.ini` is the INI to track with: min_existence = {:.2f}, the odds of "
                  "all logs.",
                  thresholdOf(best)),
      fmt::format("MOTA: one-to-one within {:g} m, all classes, {:g} m and {:.0f} deg ahead.",
                  input.evaluation.tolerance, input.evaluation.selection.range,
                  degrees(input.evaluation.selection.fov)),
      "An output on a box in an area that the truth does not label (DontCare) is not counted as "
      "false."};
  if (n == 1)
    report.remarks.push_back("One log: nothing was left out, so its figures are too good.");
  return report;
}

}  // namespace perception
