#include "studies/ResolutionReport.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libperception/evaluation/Gnuplot.h"
#include "libperception/evaluation/Metrics.h"
#include "libperception/evaluation/PaperTables.h"
#include "libperception/evaluation/PlotScript.h"
#include "libperception/measurement/CameraResolution.h"
#include "studies/ResolutionFigures.h"

namespace perception {
namespace {

constexpr double kInside = .9;       // of the range: where the detector is at its full recall
constexpr std::size_t kFewest = 10;  // objects of a point in the plot

const char* const kKinds[] = {"Car", "Person"};
const char* const kLabels[] = {"car", "person"};
const KindLabels kCameraLabels = {{{"car"}, {"person"}}};
const KindLabels kLidarLabels = {{{"car_sized", "unstable"}, {"person_sized"}}};

std::string places(const std::optional<double>& value, int n) {
  return value ? fmt::format("{:.{}f}", *value, n) : "n/a";
}

double rangeOf(const CameraResolution& row, int kind) {
  return kind == 0 ? row.car_range : row.person_range;
}

const CameraResolution& rowOf(const ResolutionRun& run) {
  return cameraResolutions()[static_cast<std::size_t>(run.resolution)];
}

/// The camera with radar alone (or alone): the run that a resolution's detections are taken from.
bool showsCamera(const ResolutionRun& run) { return run.resolution >= 0 && !run.lidar; }

/// What the tables share of one camera run.
struct CameraFigures {
  const ResolutionRun* run;
  DetectionCounts detections;
  std::optional<RangeRates> rates;
};

StudyTable resolutionTable(const std::vector<CameraFigures>& cameras) {
  StudyTable t;
  t.name = "resolutions";
  t.title = "Camera processing by resolution; ranges of the paper and measured";
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
    t.rows.push_back({fmt::format("paper: {}, {}", row.sensor, row.condition),
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

/// How far recall (normalized by range) differs between the resolutions, in its own errors.
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
  t.title = "Detections a sensor return, beside the paper's drive";
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
  t.title = "Objects tracked on average, classified as cars and persons, beside the paper's drive";
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

StudyPlot recallPlot(const std::vector<CameraFigures>& cameras, const std::string& where) {
  StudyPlot plot;
  plot.name = "recall";
  plot.caption =
      "Recall of what stands free over the distance as a share of the paper's range for that "
      "resolution; gray: the paper's figure within range. Where the curves fall together recall is "
      "independent of resolution.";
  plot.width = 1100, plot.height = 460;
  plot.script = fmt::format(
      "set multiplot layout 1,2 title {} noenhanced\nset grid\nset yrange [0:1.02]\nset xrange "
      "[0:1.6]\n"
      "set xlabel 'distance / range of the resolution'\n",
      gnuplotString(where));
  for (int k = 0; k < 2; ++k) {
    const auto paper =
        k == 0 ? paperFrontEndRows()[1].car_recall : paperFrontEndRows()[1].person_recall;
    plot.script += fmt::format(
        "set ylabel '{} recall'\nset key {}\nplot (x<=1 ? {} : 1/0) lw 6 lc rgb '{}' title 'paper'",
        k == 0 ? "car" : "person", "bottom left", paper.value_or(0), plot_color::kGray);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      const CameraFigures& c = cameras[i];
      if (!c.rates) continue;
      const std::string file = fmt::format("recall_{}_{}.dat", kLabels[k], rowOf(*c.run).name);
      std::string data;
      double middle = 0.5;
      for (const RecallCounts& r : c.rates->recall[static_cast<std::size_t>(k)]) {
        if (r.in_view >= kFewest)
          data += fmt::format("{:.3f} {:.4f}\n", middle / RangeRates::kBins,
                              *shareOf(r.named, r.in_view));
        ++middle;
      }
      if (data.empty()) continue;
      plot.data.push_back({file, data});
      plot.script +=
          fmt::format(", '{}' with linespoints lw 2 lc rgb '{}' title '{}: {:g} m'", file,
                      plot_color::ofRun(i), rowOf(*c.run).name, rangeOf(rowOf(*c.run), k));
    }
    plot.script += '\n';
  }
  plot.script += "unset multiplot\n";
  return plot;
}

/// Ours and [radecki2016]'s of a table of rates, side by side.
StudyPlot ratePlot(const StudyTable& table, const std::string& what, const std::string& where) {
  StudyPlot plot;
  plot.name = table.name;
  plot.caption = table.title + "; full: here, hatched: the paper.";
  plot.width = 1000, plot.height = 460;
  std::string data;
  for (const auto& row : table.rows) {
    data += '"' + row[0] + '"';
    for (std::size_t i = 1; i <= 6; ++i) data += ' ' + (row[i].empty() ? "?" : row[i]);
    data += '\n';
  }
  plot.data.push_back({table.name + ".dat", data});
  plot.script = fmt::format(
      "set title {} noenhanced\nset style data histograms\nset style histogram clustered gap 1.5\n"
      "set datafile missing '?'\nset logscale y\nset yrange [0.02:200]\nset grid y\n"
      "set ylabel '{}'\nset key outside right\nset boxwidth 0.95\nplot ",
      gnuplotString(where), what);
  const char* names[] = {"objects", "cars", "persons"};
  for (int i = 0; i < 3; ++i) {
    const std::string color = plot_color::ofRun(static_cast<std::size_t>(i));
    plot.script += fmt::format(
        "{0}'{1}.dat' using {2}:xtic(1) fs solid 0.9 border lc rgb '{4}' lc rgb '{4}' title '{5}', "
        "'' using {3} fs pattern 4 border lc rgb '{4}' lc rgb '{4}' title 'paper: {5}'",
        i ? ", " : "", table.name, i + 2, i + 5, color, names[i]);
  }
  plot.script += '\n';
  return plot;
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
        "Precision: share of boxes on a road user of their kind. The paper judged 300 detections "
        "by hand.");
  }
  report.remarks.push_back(
      "The paper's rates are of its own drive: what can be compared is how they grow from row to "
      "row.");
  return report;
}

}  // namespace perception
