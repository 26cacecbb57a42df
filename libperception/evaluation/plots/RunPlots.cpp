#include "libperception/evaluation/plots/RunPlots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libperception/evaluation/plots/Gnuplot.h"

namespace perception {
namespace {

using namespace plot_color;

constexpr const char* kReliability = R"(
set title {title} noenhanced font ',12'
set size square
set key inside {key} samplen 2
set xrange [0:1.05]
set yrange [0:1.05]
set xlabel {xlabel}
set ylabel {ylabel}
plot x with lines dt 2 lw 2 lc rgb 'black' title 'as often as stated'{curves}
unset output
)";

constexpr const char* kDistance = R"(
set multiplot title {title} noenhanced font ',14'
set xrange [{from:.3f}:{to:.3f}]
set lmargin 10
set rmargin {margin}
set size 1,0.49
set origin 0,0.465
set tmargin 4
set bmargin 2
set format x ''
set yrange [0:{top:.3f}]
set ylabel 'distance (m)'
set title {upper} noenhanced
plot {curves}
set tmargin 2
set origin 0,0
set size 1,0.47
set bmargin 4
set format x '%g'
set xlabel 'time since the log''s first stamp (s)'
)";

// Name of a run's curve in the key.
std::string keyName(const std::string& name, const Figure& error) {
  return error ? fmt::format("{} (mean error {:.3f})", name, *error) : name;
}

std::string timeRows(const EvaluatedRun& run) {
  std::string text =
      "# t [s], GOSPA [m], OSPA [m], localization, + missed, + false [m^2], truth, missed, false\n";
  for (const InstantFigures& i : run.evaluation.instants) {
    const Gospa& g = i.gospa;
    text += fmt::format("{:.3f} {:.5f} {:.5f} {:.5f} {:.5f} {:.5f} {} {} {}\n", i.t, g.value(),
                        i.ospa, g.localization, g.localization + g.missed, g.squared(), i.truth,
                        i.truth - g.pairs, i.estimates - g.pairs);
  }
  return text;
}

// A metric of the comparison and its value in [radecki2016].
struct Compared {
  const char* title;
  Figure (*of)(const Evaluation&);
  double PaperTrackingRow::*paper;
};
TrackingFigures closest(const Evaluation& e) { return trackingFigures(e, Pairing::kClosest); }
const Compared kCompared[] = {
    {"Object Tracked", [](const Evaluation& e) { return closest(e).tracked_a; },
     &PaperTrackingRow::tracked},
    {"Correct Classification", [](const Evaluation& e) { return closest(e).correct; },
     &PaperTrackingRow::correct},
    {"Mis-Classification", [](const Evaluation& e) { return closest(e).mis; },
     &PaperTrackingRow::mis},
    {"Range Error (m)", [](const Evaluation& e) { return closest(e).range_rms; },
     &PaperTrackingRow::range},
    {"Bearing Error (rad)", [](const Evaluation& e) { return closest(e).bearing_rms; },
     &PaperTrackingRow::bearing},
    {"False objects an instant",
     [](const Evaluation& e) { return falseObjectFigures(e).per_instant; }, nullptr},
};

// Row of [radecki2016] for the sensor set that the condition is, or ends with.
const PaperTrackingRow* paperRowOf(const std::vector<PaperTrackingRow>& rows,
                                   const std::string& name) {
  for (const PaperTrackingRow& row : rows) {
    const std::string sensors = row.sensors;
    const bool ends =
        name.size() > sensors.size() &&
        name.compare(name.size() - sensors.size() - 1, std::string::npos, " " + sensors) == 0;
    if (name == sensors || ends) return &row;
  }
  return nullptr;
}

}  // namespace

void drawSetDistance(const std::vector<const EvaluatedRun*>& runs, const EvaluationOptions& options,
                     PlotScript& script) {
  double from = 0, to = 0;
  std::string curves, numbers;
  bool any = false;
  double top = 0.1;      // [m]
  std::size_t most = 1;  // missed and false objects
  const bool several = runs.size() > 1;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const auto& instants = runs[r]->evaluation.instants;
    if (instants.empty()) continue;
    from = any ? std::min(from, instants.front().t) : instants.front().t;
    to = any ? std::max(to, instants.back().t) : instants.back().t;
    any = true;
    for (const InstantFigures& i : instants) {
      top = std::max({top, 1.05 * i.gospa.value(), 1.05 * i.ospa});
      most = std::max(most, i.truth + i.estimates - 2 * i.gospa.pairs + 1);
    }
    const std::string file = fmt::format("set_distance_{}.dat", r);
    script.data(file, timeRows(*runs[r]));
    const std::string title = gnuplotString(several ? runs[r]->name : std::string("GOSPA"));
    curves += fmt::format("{}'{}' using 1:2 with lines lw 2 lc rgb '{}' title {}",
                          curves.empty() ? "" : ", ", file, ofRun(r), title);
    numbers += fmt::format("{}'{}' using 1:($8+$9) with steps lw 2 lc rgb '{}' title {}",
                           numbers.empty() ? "" : ", ", file, ofRun(r), title);
  }
  if (!any) return;
  if (!several) {
    curves += fmt::format(
        ", 'set_distance_0.dat' using 1:3 with lines lw 2 lc rgb '{}' title 'OSPA'", kOrange);
  }
  script.begin("set_distance.png", 1200, 700);
  const std::string upper = fmt::format("cut-off {:g} m, p = 2{}", options.cutoff,
                                        several ? ": GOSPA, alpha = 2" : ", GOSPA's alpha = 2");
  script.add(fmt::format(
      kDistance,
      fmt::arg("title", gnuplotString("Distance between the sets of truth objects and outputs" +
                                      (several ? "" : ", " + runs.front()->name))),
      fmt::arg("from", from), fmt::arg("to", to), fmt::arg("top", top),
      fmt::arg("margin", several ? 30 : 24), fmt::arg("upper", gnuplotString(upper)),
      fmt::arg("curves", curves)));
  if (several) {
    script.add("set title 'missed and false objects'\nset ylabel 'number'\nset yrange [0:" +
               fmt::format("{}", most) + "]\nplot " + numbers +
               "\nunset multiplot\nunset output\n");
    return;
  }
  script.add(fmt::format(
      "set title 'parts of the squared GOSPA, which add up'\nset ylabel 'm^2' enhanced\nset yrange "
      "[0:{most}]\n"
      "plot 'set_distance_0.dat' using 1:6 with fillsteps fs solid 1 noborder lc rgb '{blue}' "
      "title 'false objects', '' using 1:5 with fillsteps fs solid 1 noborder lc rgb '{orange}' "
      "title 'missed objects', '' using 1:4 with fillsteps fs solid 1 noborder lc rgb '{green}' "
      "title 'localization'\nunset multiplot\nunset output\n",
      fmt::arg("most", 1.05 * top * top), fmt::arg("blue", kBlue), fmt::arg("orange", kOrange),
      fmt::arg("green", kGreen)));
}

void drawReliability(const std::vector<const EvaluatedRun*>& runs, bool existence,
                     PlotScript& script) {
  const std::string stem = existence ? "existence" : "reliability";
  std::string curves;
  Figure single_error;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const Evaluation& e = runs[r]->evaluation;
    const Reliability rel =
        existence ? existenceReliability(e) : reliability(e, Pairing::kOneToOne);
    if (!rel.calibration_error) continue;
    single_error = rel.calibration_error;
    std::string rows = "# mean stated probability, share of them that is so, number\n";
    for (const ReliabilityBin& bin : rel.bins) {
      if (bin.count == 0) continue;
      rows += fmt::format("{:.6f} {:.6f} {}\n", *bin.mean_probability, *bin.correct, bin.count);
    }
    const std::string file = runs.size() > 1 ? fmt::format("{}_{}.dat", stem, r) : stem + ".dat";
    script.data(file, rows);
    const std::string title = runs.size() > 1 ? keyName(runs[r]->name, rel.calibration_error)
                                              : std::string("this run, with the number of ") +
                                                    (existence ? "outputs" : "instants");
    curves +=
        fmt::format(", \\\n '{}' using 1:2 with linespoints pt 7 ps 1.3 lw 2 lc rgb '{}' title {}",
                    file, ofRun(r), gnuplotString(title));
    if (runs.size() == 1) {
      curves += ", \\\n '' using 1:2:(sprintf('%d', $3)) with labels offset -1,-1.2 notitle";
    }
  }
  if (curves.empty()) return;
  script.begin(stem + ".png", 760, 760);
  std::string title = existence ? "Reliability of the existence probability"
                                : "Reliability of the class probability";
  if (runs.size() == 1) {
    title += fmt::format(", {} (mean |stated - {}| {:.3f})", runs.front()->name,
                         existence ? "real" : "right", *single_error);
  }
  script.add(fmt::format(
      kReliability, fmt::arg("title", gnuplotString(title)),
      fmt::arg("key", existence ? "top left" : "bottom right"),
      fmt::arg("xlabel", existence ? "'stated existence probability'"
                                   : "'stated probability of the most probable class'"),
      fmt::arg("ylabel", existence ? "'share of outputs that are of a true object'"
                                   : "'share of instants at which that class is right'"),
      fmt::arg("curves", curves)));
}

void drawComparison(const EvaluationReport& report, PlotScript& script) {
  if (report.runs.size() < 2) return;
  std::string tics;
  for (std::size_t r = 0; r < report.runs.size(); ++r)
    tics += fmt::format("{}{} {}", r ? ", " : "", gnuplotString(report.runs[r].name), r);
  script.begin("comparison.png", std::max<std::size_t>(1100, 3 * (80 + 70 * report.runs.size())),
               800);
  script.add(fmt::format(
      "set multiplot layout 2,3 title 'Runs side by side: pooled instants; lines: lowest and "
      "highest trial; squares: Radecki et al.' noenhanced font ',14'\n"
      "set style fill solid 0.8 noborder\nset boxwidth 0.6\nunset key\nset grid noxtics\n"
      "set xrange [-0.6:{:.1f}]\nset xtics noenhanced rotate by 30 right ({})\n"
      "set bmargin 6\n",
      static_cast<double>(report.runs.size()) - 0.4, tics));
  for (std::size_t f = 0; f < std::size(kCompared); ++f) {
    const Compared& compared = kCompared[f];
    std::string bars = "# place, value, lowest, highest of the trials, [radecki2016]\n";
    double top = 0;
    bool in_paper = false;
    for (std::size_t r = 0; r < report.runs.size(); ++r) {
      const EvaluatedRun& run = report.runs[r];
      const Figure value = compared.of(run.evaluation);
      if (!value) continue;
      double low = *value, high = *value;
      for (const EvaluatedRun& trial : run.trials) {
        if (const Figure v = compared.of(trial.evaluation))
          low = std::min(low, *v), high = std::max(high, *v);
      }
      const PaperTrackingRow* row = compared.paper ? paperRowOf(report.paper, run.name) : nullptr;
      top = std::max({top, high, row ? row->*compared.paper : 0});
      in_paper = in_paper || row;
      bars += fmt::format("{} {:.6f} {:.6f} {:.6f} {}\n", r, *value, low, high,
                          row ? fmt::format("{:.3f}", row->*compared.paper) : std::string("nan"));
    }
    const std::string file = fmt::format("comparison_{}.dat", f);
    script.data(file, bars);
    script.add(fmt::format(
        "set title '{0}'\nset yrange [0:{1:.4f}]\n"
        "plot '{2}' using 1:2 with boxes lc rgb '{3}', '' using 1:3:(0):($4-$3) with vectors "
        "heads size 0.08,90 lw 2 lc rgb 'black', '' using 1:4:(sprintf('%.3f', $2)) with labels "
        "offset 0,0.8",
        compared.title, top > 0 ? 1.12 * top : 1, file, kBlue));
    if (in_paper) {
      script.add(fmt::format(", '' using 1:5 with points pt 5 ps 1.4 lc rgb '{}'", kOrange));
    }
    script.add("\n");
  }
  script.add("unset multiplot\nunset output\n");
}

}  // namespace perception
