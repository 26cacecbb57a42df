#include "studies/association/LogParticlesStudy.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "libperception/evaluation/metrics/Metrics.h"
#include "libperception/evaluation/plots/Gnuplot.h"
#include "libperception/evaluation/plots/PlotScript.h"
#include "libperception/evaluation/tables/PaperTables.h"

namespace perception {
namespace {

using namespace plot_color;

// One row of the study.
struct Method {
  std::string family;  // configuration, as in the tables
  const RecordedLog* log;
  ReplayMethod replay;
  std::string note;           // behind the number of particles
  std::size_t reference = 0;  // index of its reference among the methods
  bool in_curves = false;     // one of [radecki2016]'s counts

  std::string label() const { return fmt::format("{}, {}{}", family, replay.particles, note); }
};

std::string number(const std::optional<double>& value, int places) {
  return value ? fmt::format("{:.{}f}", *value, places) : "n/a";
}

// The reference first, then [radecki2016]'s counts, then the reference with another seed.
void addFamily(const LogParticlesParams& params, const std::string& family, const RecordedLog& log,
               std::vector<Method>& methods) {
  const std::size_t reference = methods.size();
  const auto add = [&](int particles, std::uint64_t seed, const std::string& note, bool curve) {
    methods.push_back(
        {family, &log, {Proposal::kSampled, particles, seed, false}, note, reference, curve});
  };
  add(params.reference, params.seed, "", false);
  for (const int n : params.counts) add(n, params.seed, "", true);
  add(params.reference, params.seed + 1, ", another seed", false);
}

std::vector<Method> methodsOf(const LogParticlesParams& params, const RecordedLog& joint,
                              const RecordedLog* duc) {
  std::vector<Method> methods;
  if (duc) addFamily(params, "DUC", *duc, methods);
  const std::size_t reference = methods.size();
  addFamily(params, "joint", joint, methods);
  methods.push_back({"joint with DUC's births",
                     &joint,
                     {Proposal::kSampled, 8, params.seed, true},
                     "",
                     reference,
                     false});
  methods.push_back(
      {"joint, ranked", &joint, {Proposal::kRanked, 8, params.seed, false}, "", reference, false});
  return methods;
}

std::string publishedOf(const Method& method) {
  if (!method.in_curves) return "";
  for (const PaperParticlesRow& row : paperParticlesRows()) {
    if (row.particles != method.replay.particles) continue;
    return method.family == "DUC" ? fmt::format("{:.2f}", row.duc)
                                  : fmt::format("{:.2f} / {:.2f}", row.all, row.classified);
  }
  return "";
}

double meanOf(const std::vector<int>& counts) {
  double sum = 0;
  for (const int c : counts) sum += c;
  return sum / std::max<double>(1, static_cast<double>(counts.size()));
}

StudyTable countTable(const std::vector<Method>& methods, const std::vector<CountedRun>& runs) {
  StudyTable table;
  table.name = "counts";
  table.title =
      "Errors in the number of objects; Radecki et al.: all objects with DUC's tracker, all / "
      "classified with classification, on their own drive";
  table.columns = {"configuration, particles", "paper", "rms of all",      "rms of classified",
                   "rms against truth",        "bias",  "things not held", "mean of all",
                   "mean of classified",       "cars",  "persons"};
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const CountErrors e = compareCounts(runs[i], runs[methods[i].reference]);
    table.rows.push_back({methods[i].label(), publishedOf(methods[i]), number(e.all, 2),
                          number(e.classified, 2), number(e.truth, 2), number(e.truth_bias, 2),
                          number(e.unheld, 2), number(meanOf(runs[i].all), 1),
                          number(meanOf(runs[i].classified), 1), number(runs[i].mean_cars, 1),
                          number(runs[i].mean_persons, 1)});
  }
  return table;
}

StudyTable trackingTable(const std::vector<Method>& methods, const std::vector<CountedRun>& runs,
                         double cutoff) {
  StudyTable table;
  table.name = "tracking";
  table.title = "Tracking against the truth, columns as in Radecki et al.";
  table.columns = {"configuration, particles",
                   "Object Tracked",
                   "Range Error (m)",
                   "Bearing Error (rad)",
                   "Correct Classification",
                   "Mis-Classification",
                   "Number of Returns",
                   "id switches",
                   "GOSPA (m)"};
  for (std::size_t i = 0; i < methods.size(); ++i) {
    if (!runs[i].evaluation) continue;
    const Evaluation& e = *runs[i].evaluation;
    const TrackingFigures f = trackingFigures(e, Pairing::kClosest);
    table.rows.push_back({methods[i].label(), number(f.tracked_a, 3), number(f.range_rms, 3),
                          number(f.bearing_rms, 3), number(f.correct, 3), number(f.mis, 3),
                          fmt::format("{}", f.returns),
                          fmt::format("{}", trackingFigures(e, Pairing::kOneToOne).id_switches),
                          number(setFigures(e, cutoff).gospa_mean, 3)});
  }
  for (const PaperTrackingRow& row : paperTrackingRows()) {
    if (row.table != std::string("particles")) continue;
    table.rows.push_back({fmt::format("Radecki et al., {} (their encounters)", row.condition),
                          number(row.tracked, 3), number(row.range, 3), number(row.bearing, 3),
                          number(row.correct, 3), number(row.mis, 3),
                          fmt::format("{}", row.returns), "", ""});
  }
  return table;
}

// A curve of a distribution of errors.
struct Curve {
  std::string name;
  std::vector<double> cdf;
};

StudyTable cdfTable(const std::vector<Method>& methods, const std::vector<CountedRun>& runs) {
  StudyTable table;
  table.name = "cdf";
  table.title = "Share of scenes with an error in the number of objects of at most so many";
  table.columns = {"configuration, particles", "objects"};
  for (std::size_t e = 0; e <= kLargestError; e += 2) table.columns.push_back(fmt::format("{}", e));
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const CountErrors errors = compareCounts(runs[i], runs[methods[i].reference]);
    for (const bool all : {true, false}) {
      std::vector<std::string> row = {methods[i].label(), all ? "all" : "classified"};
      const auto& cdf = all ? errors.cdf_all : errors.cdf_classified;
      for (std::size_t e = 0; e <= kLargestError; e += 2)
        row.push_back(fmt::format("{:.3f}", cdf[e]));
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

StudyPlot cdfPlot(const std::string& name, const std::string& title, const std::string& of,
                  const std::vector<Curve>& curves) {
  StudyPlot plot;
  plot.name = name;
  plot.caption = title + ": share of scenes at which the number of " + of +
                 " differs from that of the reference by at most so many.";
  plot.script = fmt::format(
      "set title {} noenhanced\nset grid\nset xlabel 'error in the number of {} against the "
      "reference'\nset ylabel 'share of scenes'\nset xrange [0:{}]\nset yrange [0:1.02]\n"
      "set key bottom right\nplot ",
      gnuplotString(title), of, kLargestError);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const std::string file = fmt::format("{}_{}.dat", name, i);
    std::string data;
    for (std::size_t e = 0; e < curves[i].cdf.size(); ++e)
      data += fmt::format("{} {:.4f}\n", e, curves[i].cdf[e]);
    plot.data.push_back({file, data});
    plot.script +=
        fmt::format("{}'{}' with steps lw 2 lc rgb '{}' title {} noenhanced", i ? ", " : "", file,
                    plot_color::ofRun(i), gnuplotString(curves[i].name));
  }
  plot.script += '\n';
  return plot;
}

// Errors over the number of particles, [radecki2016]'s beside them.
StudyPlot errorPlot(const std::vector<Method>& methods, const std::vector<CountedRun>& runs,
                    const std::string& where) {
  StudyPlot plot;
  plot.name = "errors";
  plot.caption =
      "Rms error in the number of objects against 50 particles, by number of particles; open "
      "symbols and dashes: Radecki et al., on their own drive.";
  std::string duc, joint, paper;
  for (std::size_t i = 0; i < methods.size(); ++i) {
    if (!methods[i].in_curves) continue;
    const CountErrors e = compareCounts(runs[i], runs[methods[i].reference]);
    const int n = methods[i].replay.particles;
    if (methods[i].family == "DUC") {
      duc += fmt::format("{} {:.4f}\n", n, e.all);
    } else {
      joint += fmt::format("{} {:.4f} {:.4f}\n", n, e.all, e.classified);
    }
  }
  for (const PaperParticlesRow& row : paperParticlesRows())
    paper += fmt::format("{} {} {} {}\n", row.particles, row.duc, row.all, row.classified);
  plot.data = {{"errors_joint.dat", joint}, {"errors_paper.dat", paper}};
  if (!duc.empty()) plot.data.push_back({"errors_duc.dat", duc});
  plot.script = fmt::format(
      "set title {} noenhanced\nset grid\nset xlabel 'particles'\nset ylabel 'rms error in the "
      "number of objects'\nset xrange [0:21]\nset yrange [0:*]\nset key outside right\nplot ",
      gnuplotString("Numbers of objects against those of 50 particles, " + where));
  if (!duc.empty())
    plot.script += fmt::format(
        "'errors_duc.dat' with linespoints lw 2 pt 7 lc rgb '{}' title 'DUC', ", kVermilion);
  plot.script += fmt::format(
      "'errors_joint.dat' using 1:2 with linespoints lw 2 pt 5 lc rgb '{0}' title 'joint', '' "
      "using 1:3 with linespoints lw 2 pt 9 lc rgb '{1}' title 'joint, classified', "
      "'errors_paper.dat' using 1:2 with linespoints dt 2 pt 6 lc rgb '{2}' title 'Radecki et al.: "
      "DUC', '' using 1:3 with linespoints dt 2 pt 4 lc rgb '{0}' title 'Radecki et al.: joint', "
      "'' using 1:4 with linespoints dt 2 pt 8 lc rgb '{1}' title 'Radecki et al.: joint, "
      "classified'\n",
      kBlue, kGreen, kVermilion);
  return plot;
}

void addPlots(const std::vector<Method>& methods, const std::vector<CountedRun>& runs,
              const std::string& where, StudyReport& report) {
  std::vector<Curve> duc, joint, eight;
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const Method& m = methods[i];
    const CountErrors e = compareCounts(runs[i], runs[m.reference]);
    const bool of_duc = m.family == "DUC", of_joint = m.family == "joint";
    const std::string particles = fmt::format("{} particle{}{}", m.replay.particles,
                                              m.replay.particles == 1 ? "" : "s", m.note);
    if (m.reference != i && of_duc) duc.push_back({particles, e.cdf_all});
    if (m.reference != i && of_joint) joint.push_back({particles, e.cdf_all});
    if (m.replay.particles != 8 || !(of_duc || of_joint)) continue;
    eight.push_back({m.family + ", all objects", e.cdf_all});
    if (of_joint) eight.push_back({"joint, classified objects", e.cdf_classified});
  }
  if (!duc.empty())
    report.plots.push_back(cdfPlot("cdf_duc", "DUC's tracker, " + where, "objects", duc));
  report.plots.push_back(cdfPlot(
      "cdf_joint", "Joint association, tracking and classification, " + where, "objects", joint));
  if (!eight.empty())
    report.plots.push_back(cdfPlot("cdf_eight", "Eight particles, " + where, "objects", eight));
  report.plots.push_back(errorPlot(methods, runs, where));
}

}  // namespace

StudyReport logParticlesStudy(const LogParticlesParams& params, const RecordedLog& joint,
                              const RecordedLog* duc, const GroundTruth* truth) {
  const std::vector<Method> methods = methodsOf(params, joint, duc);
  std::vector<CountedRun> runs(methods.size());
  // Longest runs first, to balance the threads.
  std::vector<std::size_t> order(methods.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return methods[a].replay.particles > methods[b].replay.particles;
  });
  tbb::parallel_for(
      std::size_t{0}, order.size(),
      [&](std::size_t k) {
        const Method& m = methods[order[k]];
        runs[order[k]] = countObjects(replay(*m.log, m.replay), truth, params.evaluation);
      },
      tbb::simple_partitioner());

  StudyReport report;
  report.title = "How many particles a log needs";
  report.data = fmt::format("{}{}, {} scenes", joint.simulated ? "simulated log " : "log ",
                            joint.name, runs.front().all.size());
  const std::string where = joint.name + (joint.simulated ? " (simulated)" : "");
  report.tables = {countTable(methods, runs)};
  if (truth) report.tables.push_back(trackingTable(methods, runs, params.evaluation.cutoff));
  report.tables.push_back(cdfTable(methods, runs));
  addPlots(methods, runs, where, report);
  report.remarks = {
      fmt::format("Objects count within {:g} m and {:g} deg ahead. Rms of all, of classified "
                  "objects: against {} particles of the same "
                  "configuration; those of another seed are the noise of this measure, below which "
                  "no method can be told from the reference.",
                  params.evaluation.selection.range, degrees(params.evaluation.selection.fov),
                  params.reference),
      "The rows with DUC's births and with ranked assignments have the joint configuration's "
      "reference.",
      "Classified: a class of road users with 95 % or more. Radecki et al. classified cars and "
      "pedestrians alone; what is left over was unclassified there and is static-other here."};
  if (truth) {
    report.remarks.push_back(
        "Against the truth: outputs as road users less true ones, hidden ones and outputs beside "
        "them left out on both sides; what stands around and is called a road user counts against "
        "it. Things not held: rms number of true things there (poles and hedges, too) that have no "
        "output of their own, of whatever class.");
  }
  return report;
}

}  // namespace perception
