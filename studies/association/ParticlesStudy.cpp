#include "studies/association/ParticlesStudy.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "libperception/evaluation/plots/Gnuplot.h"
#include "libperception/evaluation/tables/PaperTables.h"
#include "libperception/pipeline/input/RecordedLog.h"
#include "studies/association/EncounterRuns.h"

namespace perception {
namespace {

constexpr std::size_t kWarmUpScans = 10;  // instants: 1 s
constexpr int kParticleCounts[] = {1, 4, 8, 12, 16, 20};
constexpr int kReference = 50;
constexpr std::size_t kLargestPlotError = 12;  // objects, of the plot

/// Difficult conditions: clutter x 4, P_D x .85, noise x 2, close objects merge.
const EncounterConditions kBusy{0.85, 4, 2, 0.7};

FilterModel modelOf(const ParticlesMethod& method) {
  FilterModel model = encounterModel(method.proposal);
  if (method.duc) setDrawnBirths(model.params);
  return model;
}

template <class Of>
double rms(const std::vector<EncounterScore>& runs, Of errorOf) {
  double sum = 0, n = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    for (std::size_t k = kWarmUpScans; k < runs[r].count.size(); ++k, ++n) {
      const double e = errorOf(r, k);
      sum += e * e;
    }
  }
  return std::sqrt(sum / std::max(1.0, n));
}

double meanOf(const std::vector<EncounterScore>& runs, std::vector<int> EncounterScore::*member) {
  double sum = 0, n = 0;
  for (const auto& r : runs)
    for (const int c : r.*member) sum += c, ++n;
  return sum / std::max(1.0, n);
}

std::vector<std::string> rowOf(const std::string& label, const std::string& paper,
                               const ParticlesFigures& f) {
  return {label,
          paper,
          fmt::format("{:.2f}", f.count_rms),
          fmt::format("{:.2f}", f.classified_rms),
          fmt::format("{:.2f}", f.truth_rms),
          fmt::format("{:.2f}", f.gospa),
          fmt::format("{:.1f}", f.mean_count),
          fmt::format("{:.1f}", f.mean_classified)};
}

std::string publishedOf(int particles, bool duc) {
  for (const PaperParticlesRow& row : paperParticlesRows()) {
    if (row.particles != particles) continue;
    return duc ? fmt::format("{:.2f}", row.duc)
               : fmt::format("{:.2f} / {:.2f}", row.all, row.classified);
  }
  return "";
}

StudyPlot cdfPlot(const std::string& name, const std::string& title,
                  const std::vector<std::pair<std::string, ParticlesFigures>>& lines) {
  StudyPlot plot;
  plot.name = name;
  plot.caption = title +
                 ": share of instants at which the number of objects differs from that of "
                 "50 particles by at most so many (simulated).";
  plot.script = fmt::format(
      "set title {}\nset grid\nset xlabel 'error in the number of objects'\n"
      "set ylabel 'share of instants'\nset yrange [0:1.02]\n"
      "set key bottom right\nplot ",
      gnuplotString(title + " (simulated)"));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string file = fmt::format("{}_{}.dat", name, i);
    std::string data;
    for (std::size_t e = 0; e < lines[i].second.error_cdf.size(); ++e)
      data += fmt::format("{} {:.4f}\n", e, lines[i].second.error_cdf[e]);
    plot.data.push_back({file, data});
    plot.script += fmt::format("{}'{}' with steps lw 2 title {} noenhanced", i ? ", " : "", file,
                               gnuplotString(lines[i].first));
  }
  plot.script += '\n';
  return plot;
}

}  // namespace

std::vector<EncounterScore> runParticles(const ParticlesMethod& method, int scenes) {
  const FilterModel model = modelOf(method);
  std::vector<EncounterScore> runs(static_cast<std::size_t>(scenes));
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
    const std::uint64_t seed = i + 1;
    Rng world({seed, 0, 0, 1});
    runs[i] = runEncounter(busyStreet(world), kBusy, model, method.particles, seed,
                           1000 * method.filter_seed + i);
  });
  return runs;
}

ParticlesFigures compareParticles(const std::vector<EncounterScore>& runs,
                                  const std::vector<EncounterScore>& reference) {
  ParticlesFigures f;
  f.count_rms = rms(
      runs, [&](std::size_t r, std::size_t k) { return runs[r].count[k] - reference[r].count[k]; });
  f.classified_rms = rms(runs, [&](std::size_t r, std::size_t k) {
    return runs[r].classified[k] - reference[r].classified[k];
  });
  f.truth_rms = rms(runs, [&](std::size_t r, std::size_t k) {
    return runs[r].count[k] - runs[r].truth_count[k];
  });
  for (const auto& r : runs) f.gospa += r.gospa / static_cast<double>(runs.size());
  f.mean_count = meanOf(runs, &EncounterScore::count);
  f.mean_classified = meanOf(runs, &EncounterScore::classified);
  f.error_cdf.assign(kLargestPlotError + 1, 0);
  double instants = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    for (std::size_t k = kWarmUpScans; k < runs[r].count.size(); ++k, ++instants) {
      const auto e = static_cast<std::size_t>(std::abs(runs[r].count[k] - reference[r].count[k]));
      for (std::size_t i = e; i <= kLargestPlotError; ++i) ++f.error_cdf[i];
    }
  }
  for (double& share : f.error_cdf) share /= std::max(1.0, instants);
  return f;
}

StudyReport particlesStudy(const ParticlesParams& params) {
  StudyReport report;
  report.title = "How many particles a busy street needs";
  report.data = fmt::format(
      "simulated positions and labels of a lidar and a camera in {} busy streets of 8 s (17 "
      "objects, clutter four times, detections 85 %, noise twice, close ones merge)",
      params.scenes);
  StudyTable table;
  table.name = "counts";
  table.title =
      "Errors in the number of objects; Radecki et al.: DUC's births, or all / classified, on "
      "their own drive";
  table.columns = {
      "method",    "paper",      "rms against 50 particles", "classified", "rms against truth",
      "GOSPA [m]", "mean count", "mean classified"};
  std::vector<std::pair<std::string, ParticlesFigures>> at_eight;
  for (const bool duc : {true, false}) {
    const std::string births = duc ? "DUC births" : "joint";
    const auto reference =
        runParticles({"", Proposal::kSampled, duc, kReference, 1}, params.scenes);
    std::vector<std::pair<std::string, ParticlesFigures>> lines;
    for (const int n : kParticleCounts) {
      const auto f = compareParticles(
          runParticles({"", Proposal::kSampled, duc, n, 1}, params.scenes), reference);
      lines.push_back({fmt::format("{} particles", n), f});
      if (n == 8) at_eight.push_back({births + ", 8 particles", f});
      table.rows.push_back(rowOf(fmt::format("{}, {}", births, n), publishedOf(n, duc), f));
    }
    table.rows.push_back(rowOf(births + ", 50", "", compareParticles(reference, reference)));
    table.rows.push_back(rowOf(
        births + ", 50, another seed", "",
        compareParticles(runParticles({"", Proposal::kSampled, duc, kReference, 2}, params.scenes),
                         reference)));
    report.plots.push_back(
        cdfPlot(duc ? "cdf_duc" : "cdf_joint",
                duc ? "Births that are drawn (DUC)" : "Newborns that may be clutter", lines));
    if (duc) continue;
    for (const int n : {8, 20}) {
      const auto f = compareParticles(
          runParticles({"", Proposal::kRanked, false, n, 1}, params.scenes), reference);
      table.rows.push_back(rowOf(fmt::format("ranked, {}", n), "", f));
      if (n == 8) at_eight.push_back({"ranked, 8 hypotheses", f});
    }
  }
  report.plots.push_back(cdfPlot("cdf_eight", "Eight particles", at_eight));
  report.tables = {table};
  report.remarks = {
      "50 particles against 50 of another seed is the noise of this measure: no method can "
      "be told from the reference below it.",
      "The reference of the ranked rows is the joint filter with 50 sampled particles.",
      "Truth counts what stands in the field of view, seen or not."};
  return report;
}

}  // namespace perception
