#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "libperception/core/math/Angle.h"
#include "libperception/evaluation/plots/Gnuplot.h"
#include "studies/gps/GpsStudy.h"

namespace perception {
namespace {

constexpr std::size_t kModes = 4;

struct Published {
  double accel, rotation_deg, percent;
};
/// Tables of process noises and of classification rates in [radecki2016].
constexpr Published kPaper[kModes] = {{0.04, 0, 100}, {0.31, 15, 50}, {0.6, 15, 99}, {0.4, 15, 99}};

StudyTable noiseTable(const GpsExperiment& e) {
  StudyTable t;
  t.name = "process_noise";
  t.title =
      "Process noises by maximum likelihood (mean over left-out users; variances in (m/s^2)^2, "
      "standard deviations in deg/s) beside those of Radecki et al.";
  t.columns = {"class", "acceleration", "paper", "rotation", "paper"};
  for (std::size_t m = 0; m < kModes; ++m) {
    double accel = 0, rotation = 0;
    for (const auto& model : e.models) {
      accel += std::pow(model.filters[m].accel_sigma, 2) / static_cast<double>(e.models.size());
      rotation += degrees(model.filters[m].rotation_sigma) / static_cast<double>(e.models.size());
    }
    const bool wheeled = m > 0;
    t.rows.push_back({gpsModes()[m], fmt::format("{:.3f}", accel),
                      fmt::format("{}", kPaper[m].accel),
                      wheeled ? fmt::format("{:.1f}", rotation) : "-",
                      wheeled ? fmt::format("{}", kPaper[m].rotation_deg) : "-"});
  }
  return t;
}

StudyTable confusionTable(const GpsResult& r, const std::string& name, const std::string& title) {
  StudyTable t;
  t.name = name;
  t.title = title;
  t.columns = {"truth \\ called"};
  for (const auto& mode : gpsModes()) t.columns.push_back(mode);
  for (std::size_t m = 0; m < kModes; ++m) {
    std::vector<std::string> row{gpsModes()[m]};
    for (const double share : r.confusion[m]) row.push_back(fmt::format("{:.3f}", share));
    t.rows.push_back(row);
  }
  return t;
}

StudyPlot accuracyPlot(const std::vector<std::pair<std::string, GpsResult>>& results) {
  StudyPlot plot;
  plot.name = "accuracy";
  plot.caption =
      "Share of sections called right, by class and rule; users tested are unknown to "
      "the models.";
  std::string data;
  for (std::size_t m = 0; m < kModes; ++m) {
    data += gpsModes()[m];
    for (const auto& [name, r] : results) data += fmt::format(" {:.4f}", r.right[m]);
    data += '\n';
  }
  plot.data = {{"accuracy.dat", data}};
  plot.script =
      "set style data histograms\nset style histogram clustered gap 1\n"
      "set style fill solid 0.8\nset grid ytics\nset yrange [0:1.05]\n"
      "set ylabel 'share right'\nset key outside top center horizontal\nplot ";
  for (std::size_t i = 0; i < results.size(); ++i)
    plot.script += fmt::format("{}'accuracy.dat' using {}:xtic(1) title {} noenhanced",
                               i ? ", " : "", i + 2, gnuplotString(results[i].first));
  plot.script += '\n';
  return plot;
}

}  // namespace

StudyReport gpsStudy(const GpsParams& params) {
  const GpsExperiment e = prepareGps(params);
  StudyReport report;
  report.title = "Travel modes told apart by positions";
  report.data = fmt::format(
      "{} recordings of {} users in {}, {} draws of {} sections of {} fixes a class, every user "
      "judged by models of the others, seed {}; R = [{:.2f} {:.2f}; {:.2f} {:.2f}] m^2{}",
      e.tracks.size(), e.users.size(), std::filesystem::path(params.folder).filename().string(),
      params.draws, params.sections, params.section, params.seed, e.R(0, 0), e.R(0, 1), e.R(1, 0),
      e.R(1, 1),
      params.stationary.empty() ? " (receiver of Radecki et al.)" : " (receiver at rest)");
  const std::vector<std::pair<std::string, GpsResult>> results = {
      {"chi-square (rule of Radecki et al.)", runGps(e, params, GpsRule::kChi2)},
      {"sequential likelihood", runGps(e, params, GpsRule::kSequential)},
      {"speed regimes", runGps(e, params, GpsRule::kRegimes)}};
  StudyTable summary;
  summary.name = "summary";
  summary.title = "Share of sections called right";
  summary.columns = {"rule"};
  for (const auto& mode : gpsModes()) summary.columns.push_back(mode);
  summary.columns.push_back("balanced (deviation over draws)");
  std::vector<std::string> published{"Radecki et al. (other data)"};
  for (const auto& p : kPaper) published.push_back(fmt::format("{:.2f}", p.percent / 100));
  published.push_back("");
  summary.rows.push_back(published);
  for (const auto& [name, r] : results) {
    std::vector<std::string> row{name};
    for (const double right : r.right) row.push_back(fmt::format("{:.3f}", right));
    row.push_back(fmt::format("{:.3f} ({:.3f})", r.balanced, r.deviation));
    summary.rows.push_back(row);
  }
  report.tables = {summary, noiseTable(e),
                   confusionTable(results[0].second, "confusion_chi2", "Rule of Radecki et al."),
                   confusionTable(results[2].second, "confusion_regimes", "Speed regimes")};
  report.plots = {accuracyPlot(results)};
  const auto& c = results[2].second.confusion;
  report.remarks = {
      fmt::format("Cars and buses share roads, limits and jams: {:.0f} % of the cars' sections are "
                  "called bus and {:.0f} % of the buses' car. What tells them apart, dwelling at "
                  "stops every few hundred meters, takes longer than {} s to show.",
                  100 * c[2][3], 100 * c[3][2], params.section),
      "The speed regimes are a Markov chain over speeds per class: how fast, how steadily, how "
      "often at rest. White acceleration with one variance has no speed at all, so a slow car is "
      "as likely as a slow walker.",
      fmt::format(
          "Pedestrians are favored by the least log likelihood that finds {:.0f} % of the "
          "sections of training users, each held out in turn: they are those a vehicle must "
          "not miss.",
          100 * params.pedestrian_recall)};
  return report;
}

}  // namespace perception
