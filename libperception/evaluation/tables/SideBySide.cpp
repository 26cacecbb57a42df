#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libperception/evaluation/tables/ReportCells.h"
#include "libperception/scene/files/NumberFormat.h"

namespace perception {
namespace {

// A row of the table: a metric and its value in [radecki2016].
struct FigureRow {
  const char* name;
  int places;
  Figure (*of)(const Evaluation&, const EvaluationOptions&);
  Figure (*paper)(const PaperTrackingRow&);
};

TrackingFigures closestFigures(const Evaluation& e) {
  return trackingFigures(e, Pairing::kClosest);
}
TrackingFigures single(const Evaluation& e) { return trackingFigures(e, Pairing::kOneToOne); }
Figure none(const PaperTrackingRow&) { return {}; }
Figure figureOf(std::size_t n) { return static_cast<double>(n); }

using Options = EvaluationOptions;
using Paper = PaperTrackingRow;

const FigureRow kRows[] = {
    {"Object Tracked", 3,
     [](const Evaluation& e, const Options&) { return closestFigures(e).tracked_a; },
     [](const Paper& p) { return Figure(p.tracked); }},
    {"Object Tracked in the sensors' range", 3,
     [](const Evaluation& e, const Options&) { return closestFigures(e).tracked_b; }, none},
    {"Range Error (m)", 3,
     [](const Evaluation& e, const Options&) { return closestFigures(e).range_rms; },
     [](const Paper& p) { return Figure(p.range); }},
    {"Bearing Error (rad)", 3,
     [](const Evaluation& e, const Options&) { return closestFigures(e).bearing_rms; },
     [](const Paper& p) { return Figure(p.bearing); }},
    {"Correct Classification", 3,
     [](const Evaluation& e, const Options&) { return closestFigures(e).correct; },
     [](const Paper& p) { return Figure(p.correct); }},
    {"Mis-Classification", 3,
     [](const Evaluation& e, const Options&) { return closestFigures(e).mis; },
     [](const Paper& p) { return Figure(p.mis); }},
    {"Unclassified", 3,
     [](const Evaluation& e, const Options&) { return closestFigures(e).unclassified; },
     [](const Paper& p) { return Figure(1 - p.correct - p.mis); }},
    {"Number of Returns", 0,
     [](const Evaluation& e, const Options&) { return figureOf(closestFigures(e).returns); },
     [](const Paper& p) { return figureOf(static_cast<std::size_t>(p.returns)); }},
    {"Object Tracked, one-to-one", 3,
     [](const Evaluation& e, const Options&) { return single(e).tracked_a; }, none},
    {"id switches", 0,
     [](const Evaluation& e, const Options&) { return figureOf(single(e).id_switches); }, none},
    {"position error (m)", 3,
     [](const Evaluation& e, const Options&) { return single(e).position_rms; }, none},
    {"velocity error (m/s)", 3,
     [](const Evaluation& e, const Options&) { return single(e).velocity_rms; }, none},
    {"false objects an instant", 3,
     [](const Evaluation& e, const Options&) { return falseObjectFigures(e).per_instant; }, none},
    {"GOSPA mean (m)", 3,
     [](const Evaluation& e, const Options& o) { return setFigures(e, o.cutoff).gospa_mean; },
     none},
    {"OSPA mean (m)", 3,
     [](const Evaluation& e, const Options& o) { return setFigures(e, o.cutoff).ospa_mean; }, none},
    {"class calibration error", 3,
     [](const Evaluation& e, const Options&) {
       return reliability(e, Pairing::kOneToOne).calibration_error;
     },
     none},
    {"existence calibration error", 3,
     [](const Evaluation& e, const Options&) { return existenceReliability(e).calibration_error; },
     none},
};

// Pooled value, then mean, standard deviation and range over the trials.
std::string cellOf(const EvaluatedRun& run, const FigureRow& row,
                   const EvaluationOptions& options) {
  std::string value = number(row.of(run.evaluation, options), row.places);
  std::vector<double> trials;
  for (const EvaluatedRun& trial : run.trials) {
    if (const Figure f = row.of(trial.evaluation, options)) trials.push_back(*f);
  }
  if (trials.size() < 2) return value;
  double mean = 0, square = 0;
  for (const double v : trials) mean += v / static_cast<double>(trials.size());
  for (const double v : trials) square += (v - mean) * (v - mean);
  const double sd = std::sqrt(square / static_cast<double>(trials.size() - 1));
  const auto [low, high] = std::minmax_element(trials.begin(), trials.end());
  const int places = std::max(row.places, 1);
  return fmt::format("{} ({} +- {}; {}..{})", value, fixedPlaces(mean, places),
                     fixedPlaces(sd, places), fixedPlaces(*low, row.places),
                     fixedPlaces(*high, row.places));
}

}  // namespace

ReportTable sideBySideTable(const EvaluationReport& report) {
  ReportTable table;
  table.title = "Runs side by side";
  table.header = {"Figure"};
  bool trials = false;
  for (const EvaluatedRun& run : report.runs) {
    table.header.push_back(
        run.trials.empty() ? run.name : fmt::format("{}, {} trials", run.name, run.trials.size()));
    trials = trials || !run.trials.empty();
  }
  for (const PaperTrackingRow& row : report.paper)
    table.header.push_back(fmt::format("Radecki et al.: {}, {}", row.sensors, row.condition));
  for (const FigureRow& row : kRows) {
    std::vector<std::string> cells = {row.name};
    for (const EvaluatedRun& run : report.runs) cells.push_back(cellOf(run, row, report.options));
    for (const PaperTrackingRow& paper : report.paper) {
      const Figure f = row.paper(paper);
      cells.push_back(f ? number(f, row.places) : "");
    }
    table.rows.push_back(std::move(cells));
  }
  table.notes = {
      "Closest matching as in Radecki et al. down to Number of Returns, one-to-one below. The "
      "sensors' range: all with lidar, else 15 m, persons 10 m."};
  if (trials) {
    table.notes.push_back(
        "Of all trials' instants taken together, as in Radecki et al.; in brackets mean +- "
        "standard deviation over the trials; lowest..highest trial.");
  }
  return table;
}

}  // namespace perception
