#include "studies/labels/LabelsPlots.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "libperception/evaluation/plots/Gnuplot.h"
#include "libperception/evaluation/plots/PlotScript.h"

namespace perception {
namespace {

/// A curve of the plots and its style.
struct Line {
  LabelMethod method;
  const char* file;
  const char* title;
  std::string style;
};

std::vector<Line> lines() {
  return {
      {kJointTracker, "joint", "joint", fmt::format("lw 2 pt 7 lc rgb '{}'", plot_color::kBlue)},
      {kTrackerPerClass, "per_class", "per class",
       fmt::format("lw 2 pt 5 lc rgb '{}'", plot_color::kRed)},
      {kTrackerPerClassAll, "per_class_all", "unlabeled to all",
       fmt::format("lw 2 pt 9 lc rgb '{}'", plot_color::kOrange)}};
}

// The points of one line over the share of corrupted labels: share, MOTA by class, MOTA and id
// switches ignoring class, share correct after 10.
std::string pointsOf(const std::vector<LabelCondition>& conditions, LabelNoise::Kind kind,
                     const LabelMethod& method) {
  std::string text;
  for (const LabelCondition& c : conditions) {
    const bool none = c.damage.kind == LabelNoise::kNone;
    const bool same = std::string(c.method.name) == method.name ||
                      (none && c.method.per_class && method.per_class);
    if (!same || !(none || c.damage.kind == kind)) continue;
    const ClearFigures by_class = sumOf(c.score.of_class);
    const std::size_t k = std::min<std::size_t>(10, c.score.objects.front().size());
    // All labels dropped: 100 %, drawn at 70 after a gap.
    text += fmt::format("{:.0f} {} {} {} {}\n",
                        c.damage.probability >= 1 ? 70 : 100 * c.damage.probability,
                        percent(by_class.mota), percent(c.score.any_class.mota),
                        c.score.any_class.id_switches, percent(rightShare(c.score, k)));
  }
  return text;
}

/// A panel of the plot: one metric, a column of the data.
struct Panel {
  const char* label;
  const char* range;
  int column;
};
constexpr Panel kPanels[] = {{"MOTA by class (%)", "[*:100]", 2},
                             {"MOTA, whatever class (%)", "[*:100]", 3},
                             {"identity switches", "[0:*]", 4},
                             {"right class after 10 (%)", "[0:100]", 5}};

}  // namespace

StudyPlot figuresPlot(const std::vector<LabelCondition>& conditions, const std::string& where) {
  StudyPlot plot;
  plot.name = "labels";
  plot.width = 1100, plot.height = 1200;
  plot.caption =
      "Joint classification beside a tracker per class, over the share of labels that were dropped "
      "(left) or flipped (right): MOTA by class and whatever the class, identity switches whatever "
      "the class, and objects with an output of the right class at their tenth measurement.";
  plot.script = fmt::format(
      "set multiplot layout 4,2 title {} noenhanced\nset grid\nset datafile missing 'n/a'\n"
      "set lmargin 10\nset key outside top center horizontal font ',9' samplen 2\n",
      gnuplotString("What labels are worth, " + where));
  for (const Panel& panel : kPanels) {
    for (const auto kind : {LabelNoise::kDropped, LabelNoise::kFlipped}) {
      const bool dropped = kind == LabelNoise::kDropped;
      const char* how = dropped ? "dropped" : "flipped";
      plot.script += fmt::format(
          "set key width {}\nset xlabel 'labels {} (%)'\nset ylabel '{}'\nset yrange {}\n"
          "set xrange [-2:{}]\n"
          "set xtics ({}'0' 0, '10' 10, '20' 20, '30' 30, '40' 40, '50' 50)\nplot ",
          dropped ? -4 : 0, how, panel.label, panel.range, dropped ? 75 : 52,
          dropped ? "'none left' 70, " : "");
      bool first = true;
      for (const Line& line : lines()) {
        if (!dropped && line.method.takes_unlabeled && line.method.per_class) continue;
        const std::string file = fmt::format("labels_{}_{}.dat", how, line.file);
        if (panel.column == 2) plot.data.push_back({file, pointsOf(conditions, kind, line.method)});
        plot.script += fmt::format(
            "{}'{}' using 1:{} with linespoints {} {}", first ? "" : ", ", file, panel.column,
            line.style,
            panel.column == 2 ? fmt::format("title '{}'", line.title) : std::string("notitle"));
        first = false;
      }
      plot.script += '\n';
    }
  }
  plot.script += "unset multiplot\n";
  return plot;
}

StudyPlot curvePlot(const std::vector<LabelCondition>& conditions, const LabelsParams& params,
                    const std::string& where) {
  StudyPlot plot;
  plot.name = "right_class";
  plot.width = 1100, plot.height = 550;
  plot.caption =
      "Share of objects that have an output of the right class at their k-th measurement; full "
      "lines: joint classification, dashes: a tracker per class (unlabeled boxes left out).";
  plot.script = fmt::format(
      "set multiplot layout 1,2 title {} noenhanced\nset grid\nset key bottom right\n"
      "set datafile missing 'n/a'\nset xlabel 'measurements of the object'\n"
      "set ylabel 'output of the right class (%)'\nset xrange [0:{}]\nset yrange [0:100]\n",
      gnuplotString("Class by number of measurements, " + where), params.last_measurement + 1);
  for (const auto kind : {LabelNoise::kDropped, LabelNoise::kFlipped}) {
    plot.script += fmt::format("set title 'labels {}'\nplot ",
                               kind == LabelNoise::kDropped ? "dropped" : "flipped");
    bool first = true;
    std::map<std::string, std::size_t> color;
    for (std::size_t i = 0; i < conditions.size(); ++i) {
      const LabelCondition& c = conditions[i];
      const double p = c.damage.probability;
      const bool shown = p == 0 || p >= 1 || p == params.shares.back() ||
                         p == params.shares[params.shares.size() / 2];
      if (!shown || (c.damage.kind != kind && c.damage.kind != LabelNoise::kNone)) continue;
      if (c.method.per_class && c.method.takes_unlabeled) continue;
      const std::string file = fmt::format("right_class_{}.dat", i);
      std::string data;
      for (std::size_t k = 1; k <= static_cast<std::size_t>(params.last_measurement); ++k)
        data += fmt::format("{} {}\n", k, percent(rightShare(c.score, k)));
      if (plot.data.end() == std::find_if(plot.data.begin(), plot.data.end(),
                                          [&](const auto& d) { return d.first == file; }))
        plot.data.push_back({file, data});
      const std::size_t hue = color.try_emplace(c.labels(), color.size()).first->second;
      plot.script +=
          fmt::format("{}'{}' with lines lw 2 dt {} lc rgb '{}' title {} noenhanced",
                      first ? "" : ", ", file, c.method.per_class ? 2 : 1, plot_color::ofRun(hue),
                      gnuplotString(c.labels() + ", " + c.method.name));
      first = false;
    }
    plot.script += '\n';
  }
  plot.script += "unset multiplot\n";
  return plot;
}

}  // namespace perception
