#include "studies/resolution/ResolutionFigures.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

constexpr std::array<const char*, kResolutionKinds> kClasses = {"car", "pedestrian"};
constexpr double kShare = 0.95;  // of the measurements, within their reach

bool contains(const std::vector<std::string>& list, const std::string& text) {
  return std::find(list.begin(), list.end(), text) != list.end();
}

std::size_t tenths(double share) {
  return static_cast<std::size_t>(std::lround(share * RangeRates::kBins));
}

}  // namespace

std::optional<double> shareOf(std::size_t part, std::size_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

RecallCounts RangeRates::within(int kind, double from, double to) const {
  RecallCounts sum;
  for (std::size_t b = tenths(from); b < tenths(to); ++b)
    sum += recall[static_cast<std::size_t>(kind)][b];
  return sum;
}

std::optional<double> RangeRates::recallIn(int kind, double from, double to) const {
  const RecallCounts counts = within(kind, from, to);
  return shareOf(counts.named, counts.in_view);
}

std::optional<double> RangeRates::halfRange(int kind) const {
  const auto k = static_cast<std::size_t>(kind);
  auto near = recallIn(kind, 0, .5);
  if (!near) near = recallIn(kind, .5, .9);
  if (!near || *near <= 0) return std::nullopt;
  double before = *near;
  for (std::size_t b = kBins / 2; b < kLastBin; ++b) {
    const auto here = shareOf(recall[k][b].named, recall[k][b].in_view);
    if (!here) continue;
    if (*here < *near / 2) {  // between the middles of two bins
      const double part = (before - *near / 2) / (before - *here);
      return range[k] / kBins * (static_cast<double>(b) - 0.5 + part);
    }
    before = *here;
  }
  return std::nullopt;
}

RangeRates rangeRates(const MeasurementRun& run, const std::string& sensor,
                      const GroundTruth& truth, std::array<double, kResolutionKinds> range,
                      const KindLabels& labels) {
  RangeRates rates;
  rates.range = range;
  MeasurementRun wide = run;
  for (std::size_t kind = 0; kind < kResolutionKinds; ++kind) {
    const double bin = range[kind] / RangeRates::kBins;
    // Recall beyond the range that the INI claims is of interest, too.
    for (RecordedSensor& s : wide.sensors)
      s.class_range.assign(s.class_range.size(), bin * RangeRates::kLastBin);
    FrontEndOptions options;
    options.center_range = true;
    options.selection.max_occluded = 0;
    options.alignment.time_limit = 0.1;
    options.range_edges.clear();
    for (int b = 0; b <= RangeRates::kLastBin; ++b) options.range_edges.push_back(b * bin);
    const FrontEndEvaluation e = evaluateFrontEnd(wide, sensor, truth, options);
    for (std::size_t c = 0; c < e.class_names.size(); ++c) {
      if (e.class_names[c] == kClasses[kind])
        std::copy(e.visible[c].begin(), e.visible[c].end(), rates.recall[kind].begin());
    }
    for (const std::string& label : labels[kind]) rates.precision[kind] += e.precision(label);
  }
  return rates;
}

double DetectionCounts::mean(int kind) const {
  const auto n = static_cast<double>(ranges[static_cast<std::size_t>(kind)].size());
  return scans > 0 ? n / scans : 0;
}

std::optional<double> DetectionCounts::reach(int kind) const {
  std::vector<double> sorted = ranges[static_cast<std::size_t>(kind)];
  if (sorted.empty()) return std::nullopt;
  std::sort(sorted.begin(), sorted.end());
  return sorted[static_cast<std::size_t>(kShare * static_cast<double>(sorted.size() - 1))];
}

DetectionCounts detectionCounts(const MeasurementRun& run, const std::string& sensor,
                                const KindLabels& labels) {
  DetectionCounts counts;
  for (const RecordedScan& scan : run.scans) {
    if (run.sensors[scan.sensor].label != sensor) continue;
    ++counts.scans;
    for (const RecordedMeasurement& m : scan.measurements) {
      ++counts.all;
      for (std::size_t kind = 0; kind < kResolutionKinds; ++kind) {
        if (contains(labels[kind], m.label)) counts.ranges[kind].push_back(m.range);
      }
    }
  }
  return counts;
}

TrackedCounts trackedCounts(const TrackedRun& run) {
  TrackedCounts counts;
  for (const Scene& scene : run.scenes) {
    for (const SceneObject& o : scene.objects) {
      ++counts.all;
      const std::string& name = run.class_names[static_cast<std::size_t>(o.class_id)];
      for (std::size_t k = 0; k < kResolutionKinds; ++k)
        counts.kind[k] += o.classified && name == kClasses[k] ? 1 : 0;
    }
  }
  const double scenes = std::max<double>(1, static_cast<double>(run.scenes.size()));
  counts.all /= scenes;
  for (double& n : counts.kind) n /= scenes;
  return counts;
}

}  // namespace perception
