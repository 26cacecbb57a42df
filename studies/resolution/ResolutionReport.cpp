#include "studies/resolution/ResolutionReport.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libperception/evaluation/metrics/Metrics.h"
#include "libperception/evaluation/tables/PaperTables.h"
#include "studies/resolution/ResolutionPlots.h"

namespace perception {
namespace {

constexpr double kInside = .9;  // of the range: where the detector is at its full recall

const char* const kKinds[] = {"Car", "Person"};
const KindLabels kCameraLabels = {{{"car"}, {"person"}}};
const KindLabels kLidarLabels = {{{"car_sized", "unstable"}, {"person_sized"}}};

std::string places(const std::optional<double>& value, int n) {
  return value ? fmt::format("{:.{}f}", *value, n) : "n/a";
}

/// The run C+R (or C) from which the detections of a resolution are taken.
bool showsCamera(const ResolutionRun& run) { return run.resolution >= 0 && !run.lidar; }

StudyTable resolutionTable(const std::vector<CameraFigures>& cameras) {
  StudyTable t;
  t.name = "resolutions";
  t.title = "Camera processing by resolution; ranges of Radecki et al. and measured";
  t.columns = {"resolution",
               "panorama",
               "tile",
               "car range, paper [m]",
               "car recall halves at",
               "95 % of car boxes within",
               "person range, paper",
               "person recall halves at",
               "95 % of person boxes within"};
  for (const CameraFigures& c : cameras) {
    const CameraResolution& row = rowOf(*c.run);
    std::vector<std::string> cells = {row.name, fmt::format("{}x{}", row.width, row.height),
                                      fmt::format("{0}x{0}", row.width / 4)};
    for (int k = 0; k < 2; ++k) {
      cells.push_back(fmt::format("{:g}", rangeOf(row, k)));
      cells.push_back(places(c.rates ? c.rates->halfRange(k) : std::nullopt, 1));
      cells.push_back(places(c.detections.reach(k), 1));
    }
    t.rows.push_back(std::move(cells));
  }
  return t;
}

StudyTable recallTable(const std::vector<CameraFigures>& cameras,
                       const std::optional<RangeRates>& lidar) {
  StudyTable t;
  t.name = "recall_precision";
  t.title = "Recall within nine tenths of the sensor's range, precision";
  t.columns = {"sensor",  "car recall",      "cars", "car precision", "person recall",
               "persons", "person precision"};
  const auto add = [&](const std::string& name, const RangeRates& r) {
    std::vector<std::string> cells = {name};
    for (int k = 0; k < 2; ++k) {
      cells.push_back(places(r.recallIn(k, 0, kInside), 3));
      cells.push_back(fmt::format("{}", r.within(k, 0, kInside).in_view));
      cells.push_back(places(shareOf(r.precision[static_cast<std::size_t>(k)].right_class,
                                     r.precision[static_cast<std::size_t>(k)].measurements),
                             3));
    }
    t.rows.push_back(std::move(cells));
  };
  for (const CameraFigures& c : cameras) {
    if (c.rates) add(fmt::format("C-{}", rowOf(*c.run).name), *c.rates);
  }
  if (lidar) add("L", *lidar);
  for (const PaperFrontEndRow& row : paperFrontEndRows()) {
    t.rows.push_back({fmt::format("Radecki et al.: {}, {}", row.sensor, row.condition),
                      places(row.car_recall, 2), "", places(row.car_precision, 2),
                      places(row.person_recall, 2), "", places(row.person_precision, 2)});
  }
  return t;
}

StudyTable byRangeTable(const std::vector<CameraFigures>& cameras) {
  StudyTable t;
  t.name = "recall_by_range";
  t.title = "Recall by share of the sensor's range";
  t.columns = {"sensor", "kind", "0 to .3", ".3 to .5", ".5 to .7", ".7 to .9", "1.1 to 1.6"};
  for (int k = 0; k < 2; ++k) {
    for (const CameraFigures& c : cameras) {
      if (!c.rates) continue;
      std::vector<std::string> cells = {fmt::format("C-{}", rowOf(*c.run).name), kKinds[k]};
      constexpr double kEdges[] = {0, .3, .5, .7, .9};
      for (int e = 0; e < 4; ++e)
        cells.push_back(places(c.rates->recallIn(k, kEdges[e], kEdges[e + 1]), 3));
      cells.push_back(places(c.rates->recallIn(k, 1.1, 1.6), 3));
      t.rows.push_back(std::move(cells));
    }
  }
  return t;
}

/// Difference of the range-normalized recall between resolutions, in standard errors.
std::string independence(const std::vector<CameraFigures>& cameras, int kind) {
  double low = 1, high = 0, worst = 0, right = 0, all = 0;
  int n = 0;
  for (const CameraFigures& c : cameras) {
    if (!c.rates) continue;
    const RecallCounts r = c.rates->within(kind, 0, kInside);
    if (r.in_view == 0) continue;
    const double recall = *shareOf(r.named, r.in_view);
    low = std::min(low, recall), high = std::max(high, recall);
    right += static_cast<double>(r.named), all += static_cast<double>(r.in_view);
    ++n;
  }
  if (n < 2) return "";
  const double mean = right / all;
  for (const CameraFigures& c : cameras) {
    if (!c.rates) continue;
    const RecallCounts r = c.rates->within(kind, 0, kInside);
    if (r.in_view == 0 || mean <= 0 || mean >= 1) continue;
    const double error = std::sqrt(mean * (1 - mean) / static_cast<double>(r.in_view));
    worst = std::max(worst, std::abs(*shareOf(r.named, r.in_view) - mean) / error);
  }
  return fmt::format(
      "{} recall normalized by range: {:.3f} to {:.3f} over the resolutions, at most {:.1f} "
      "standard errors from their mean (of independent images, which these are not).",
      kKinds[kind], low, high, worst);
}

std::vector<std::string> paperCells(const std::string& sensors, bool tracked) {
  for (const PaperRateRow& row : paperRateRows()) {
    if (row.tracked == tracked && sensors == row.sensors)
      return {fmt::format("{:.2f}", row.objects), fmt::format("{:.2f}", row.cars),
              fmt::format("{:.2f}", row.persons)};
  }
  return {"", "", ""};
}

void addRates(StudyTable& t, const std::string& name, const double (&ours)[3], bool tracked,
              std::vector<std::string> more = {}) {
  std::vector<std::string> cells = {name};
  for (const double v : ours) cells.push_back(fmt::format("{:.2f}", v));
  for (std::string& p : paperCells(name, tracked)) cells.push_back(std::move(p));
  for (std::string& m : more) cells.push_back(std::move(m));
  t.rows.push_back(std::move(cells));
}

StudyTable detectionTable(const std::vector<CameraFigures>& cameras,
                          const std::optional<DetectionCounts>& lidar) {
  StudyTable t;
  t.name = "detection_rate";
  t.title = "Detections per sensor return, and those of Radecki et al. on their drive";
  t.columns = {"sensors", "objects", "cars", "persons", "paper: objects", "cars", "persons"};
  const auto add = [&](const std::string& name, const DetectionCounts& d) {
    addRates(t, name, {d.mean(), d.mean(0), d.mean(1)}, false);
  };
  for (const CameraFigures& c : cameras) add(fmt::format("C-{}", rowOf(*c.run).name), c.detections);
  if (lidar) add("L", *lidar);
  return t;
}

StudyTable trackingTable(const ResolutionData& data) {
  StudyTable t;
  t.name = "tracking_rate";
  t.title =
      "Objects tracked on average, classified as cars and persons, and those of Radecki et al. on "
      "their drive";
  t.columns = {"sensors", "objects", "cars", "persons", "paper: objects", "cars", "persons"};
  if (data.truth)
    t.columns.insert(t.columns.end(),
                     {"tracked within 20 m", "range rms [m]", "correct class", "wrong class"});
  for (const ResolutionRun& run : data.runs) {
    const TrackedCounts m = trackedCounts(run.tracks);
    std::vector<std::string> more;
    if (data.truth) {
      const auto f = trackingFigures(evaluate(run.tracks, *data.truth, {}), Pairing::kClosest);
      more = {places(f.tracked_a, 3), places(f.range_rms, 3), places(f.correct, 3),
              places(f.mis, 3)};
    }
    addRates(t, run.name, {m.all, m.kind[0], m.kind[1]}, true, std::move(more));
  }
  return t;
}

}  // namespace

StudyReport resolutionReport(const ResolutionData& data) {
  std::vector<CameraFigures> cameras;
  std::optional<RangeRates> lidar;
  std::optional<DetectionCounts> lidar_detections;
  for (const ResolutionRun& run : data.runs) {
    if (showsCamera(run)) {
      const CameraResolution& row = rowOf(run);
      CameraFigures c{&run, detectionCounts(run.measurements, data.camera, kCameraLabels), {}};
      if (data.truth)
        c.rates = rangeRates(run.measurements, data.camera, *data.truth,
                             {row.car_range, row.person_range}, kCameraLabels);
      cameras.push_back(std::move(c));
    } else if (run.resolution < 0 && run.lidar) {
      constexpr double kLidarRange = 70;  // [m] "Lidar clustering maximum range"
      lidar_detections = detectionCounts(run.measurements, data.lidar, kLidarLabels);
      if (data.truth)
        lidar = rangeRates(run.measurements, data.lidar, *data.truth, {kLidarRange, kLidarRange},
                           kLidarLabels);
    }
  }
  StudyReport report;
  report.title = "What the camera's resolution is worth";
  report.data = data.source;
  report.tables = {resolutionTable(cameras)};
  if (data.truth) {
    report.tables.push_back(recallTable(cameras, lidar));
    report.tables.push_back(byRangeTable(cameras));
    report.plots.push_back(recallPlot(cameras, data.source));
  }
  report.tables.push_back(detectionTable(cameras, lidar_detections));
  report.plots.push_back(ratePlot(report.tables.back(), "detections a sensor return", data.source));
  report.tables.push_back(trackingTable(data));
  report.plots.push_back(ratePlot(report.tables.back(), "objects a scene", data.source));
  report.remarks = data.remarks;
  if (data.truth) {
    for (int k = 0; k < 2; ++k) {
      const std::string line = independence(cameras, k);
      if (!line.empty()) report.remarks.push_back(line);
    }
    report.remarks.push_back(
        "Recall: of objects of which three quarters are visible, found by a box of the right kind. "
        "Precision: share of boxes on a road user of their kind. Radecki et al. judged 300 "
        "detections by hand.");
  }
  report.remarks.push_back(
      "Radecki et al.'s rates are of their own drive: what can be compared is how they grow from "
      "row to row.");
  return report;
}

}  // namespace perception
