#include "studies/weather/TrustStudy.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <utility>

#include "libperception/calibration/clusters/PointLabels.h"
#include "libperception/core/Error.h"
#include "libperception/evaluation/plots/Gnuplot.h"
#include "libperception/pipeline/input/LogRecorder.h"
#include "studies/weather/TrustScore.h"

namespace perception {
namespace {

constexpr double kDoubted = 0.5;
constexpr double kThresholds[] = {0.01, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.99};
constexpr double kRanges[] = {0, 10, 20, 40, std::numeric_limits<double>::infinity()};  // [m]
constexpr std::size_t kRangeBins = std::size(kRanges) - 1;

/// SemanticKITTI's vehicles, persons, riders; moving ones are 252 and up.
bool isRoadUserLabel(std::uint16_t label) {
  return label == 10 || label == 11 || label == 13 || (label >= 15 && label <= 20) ||
         (label >= 30 && label <= 32) || (label >= 252 && label <= 259);
}

/// Scores every labeled scan as it goes to its front end.
class TrustObserver : public PipelineObserver {
 public:
  explicit TrustObserver(const TrustOptions& options) : options_(options), labels_(options.log) {}

  void onFrame(const SensorFrame& frame) override {
    const auto* cloud = std::get_if<LidarCloud>(&frame.data);
    if (!cloud || (options_.even && frame.frame % 2 != 0)) return;
    const auto labels = labels_.ofFrame(frame.frame, cloud->size());
    if (!labels) {
      ++unlabeled;
      return;
    }
    ++scans;
    for (std::size_t i = 0; i < labels->size(); ++i) {
      const float trust = cloud->trust.empty() ? 1.F : cloud->trust[i];
      const auto range = static_cast<double>(std::hypot(cloud->x[i], cloud->y[i], cloud->z[i]));
      std::size_t bin = 0;
      while (bin + 1 < kRangeBins && range >= kRanges[bin + 1]) ++bin;
      all.add(trust, (*labels)[i]);
      by_range[bin].add(trust, (*labels)[i]);
    }
  }

 private:
  const TrustOptions& options_;
  PointLabels labels_;

 public:
  TrustScore all;
  std::array<TrustScore, kRangeBins> by_range;
  std::size_t scans = 0, unlabeled = 0;
};

std::string figure(const std::optional<double>& value) {
  return value ? fmt::format("{:.4f}", *value) : "n/a";
}

std::vector<std::string> ratesRow(const std::string& label, const TrustScore::Rates& r) {
  return {label,
          fmt::format("{}", r.found + r.missed),
          fmt::format("{}", r.found),
          fmt::format("{}", r.false_alarms),
          figure(r.precision),
          figure(r.recall),
          figure(r.f1)};
}

StudyTable ratesTable(const std::string& name, const std::string& title, const std::string& first) {
  return {name,
          title,
          {first, "phantoms", "found", "surfaces doubted", "precision", "recall", "F1"},
          {}};
}

StudyTable kindsTable(const TrustScore& score) {
  StudyTable table = ratesTable(
      "kinds", "Phantoms at trust < 0.5; a kind against all doubted surfaces", "phantoms");
  table.rows.push_back(ratesRow("all", score.at(kDoubted)));
  for (const auto& [label, counts] : score.byLabel()) {
    if (isPhantomLabel(label))
      table.rows.push_back(ratesRow(nameOfPhantom(label), score.at(kDoubted, label)));
  }
  return table;
}

StudyTable rangesTable(const std::array<TrustScore, kRangeBins>& scores) {
  StudyTable table = ratesTable("ranges", "By range, at trust < 0.5", "range [m]");
  for (std::size_t b = 0; b < kRangeBins; ++b) {
    const std::string name = b + 1 < kRangeBins
                                 ? fmt::format("{:g} to {:g}", kRanges[b], kRanges[b + 1])
                                 : fmt::format("from {:g} on", kRanges[b]);
    table.rows.push_back(ratesRow(name, scores[b].at(kDoubted)));
  }
  return table;
}

StudyTable curveTable(const TrustScore& score) {
  StudyTable table = ratesTable("curve", "By threshold", "trust below");
  for (const double threshold : kThresholds)
    table.rows.push_back(ratesRow(fmt::format("{:g}", threshold), score.at(threshold)));
  return table;
}

StudyTable surfacesTable(const TrustScore& score) {
  TrustHistogram users, others;
  for (const auto& [label, counts] : score.byLabel()) {
    if (isPhantomLabel(label) || (label == 0 && !score.unlabeled_is_surface)) continue;
    (isRoadUserLabel(label) ? users : others) += counts;
  }
  StudyTable table = {"surfaces", "Surfaces lost", {"surfaces", "returns", "doubted", "share"}, {}};
  const auto add = [&](const std::string& name, const TrustHistogram& h) {
    const std::size_t doubted = h.below(kDoubted);
    table.rows.push_back({name, fmt::format("{}", h.total()), fmt::format("{}", doubted),
                          h.total() > 0
                              ? fmt::format("{:.3f} %", 100 * static_cast<double>(doubted) /
                                                            static_cast<double>(h.total()))
                              : "n/a"});
  };
  add("road users", users);
  add("others", others);
  return table;
}

StudyTable reliabilityTable(const TrustScore& score) {
  StudyTable table = {
      "reliability",
      fmt::format("Reliability; average precision {}, calibration error {}",
                  figure(score.averagePrecision()), figure(score.calibrationError())),
      {"P(phantom) said", "share of phantoms", "returns"},
      {}};
  for (const TrustScore::Bin& bin : score.reliability())
    table.rows.push_back({fmt::format("{:.3f}", bin.stated), fmt::format("{:.3f}", bin.phantoms),
                          fmt::format("{}", bin.returns)});
  return table;
}

StudyPlot curvePlot(const TrustScore& score, const std::string& title) {
  StudyPlot plot;
  plot.name = "precision_recall";
  plot.caption = "Precision and recall of phantoms over all thresholds of trust.";
  std::string data;
  for (int k = 1; k < 1000; k += 2) {
    const TrustScore::Rates r = score.at(k / 1000.0);
    if (r.precision && r.recall) data += fmt::format("{:.5f} {:.5f}\n", *r.recall, *r.precision);
  }
  if (data.empty()) data = "0 0\n";
  plot.data.push_back({"precision_recall.dat", data});
  plot.script = fmt::format(
      "set title {} noenhanced\nset grid\nset xlabel 'recall'\nset ylabel 'precision'\n"
      "set xrange [0:1]\nset yrange [0:1.02]\n"
      "plot 'precision_recall.dat' with lines lw 2 notitle\n",
      gnuplotString(title));
  return plot;
}

}  // namespace

void declareTrust(CLI::App& cli, TrustOptions& o) {
  cli.add_option("-i,--input", o.log, "Rawlog with labels of points in LOG_Labels/")
      ->required()
      ->check(CLI::ExistingFile);
  cli.add_option("-c,--config", o.config, "INI of the vehicle")
      ->capture_default_str()
      ->check(CLI::ExistingFile);
  cli.add_option("--set", o.settings, "section.key=value: overrides the INI");
  cli.add_option("--seconds", o.seconds, "Of the log; 0 = all")->check(CLI::Range(0.0, 1e6));
  cli.add_flag("--even", o.even,
               "Count frames of even number alone (trust was fitted to odd ones of WADS)");
}

StudyReport trustStudy(const TrustOptions& options) {
  const std::string name = std::filesystem::path(options.log).stem().string();
  std::vector<std::string> settings = options.settings;
  settings.emplace_back("run.sensors=L");
  PipelineSetup setup = PipelineSetup::fromFile(options.config, settings);
  TrustObserver observer(options);
  const LogPass passed =
      passLog(options.log, forFrontEnds(std::move(setup)), options.seconds, observer);
  // A simulation knows what every return comes from.
  observer.all.unlabeled_is_surface = passed.simulated;
  for (TrustScore& s : observer.by_range) s.unlabeled_is_surface = passed.simulated;
  if (observer.scans == 0)
    throw DataError(options.log + ": no scan of a lidar in use has labels in " + name +
                    "_Labels/ beside the log");
  const TrustScore& score = observer.all;
  StudyReport report;
  report.title = "Trust of returns against labels of points: " + name;
  report.data =
      fmt::format("{}{}, {} scans{}, {}", passed.simulated ? "simulated phantoms: " : "", name,
                  observer.scans, options.even ? " of even number" : "", options.config);
  report.tables = {kindsTable(score), rangesTable(observer.by_range), curveTable(score),
                   surfacesTable(score), reliabilityTable(score)};
  report.plots = {curvePlot(score, name + (passed.simulated ? " (simulated phantoms)" : ""))};
  report.remarks = {passed.simulated
                        ? "Returns with label 0 are surfaces: the simulation labels every phantom."
                        : "Returns with label 0 (unlabeled) are in no figure.",
                    "Doubted: trust < 0.5. Beyond [weather.trust] max_range nothing is doubted by "
                    "its neighbors."};
  if (observer.unlabeled > 0)
    report.remarks.push_back(fmt::format("{} scans have no labels.", observer.unlabeled));
  return report;
}

}  // namespace perception
