#include "studies/LabelsReport.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>

#include "libperception/evaluation/Gnuplot.h"
#include "libperception/evaluation/PlotScript.h"

namespace perception {
namespace {

ClearFigures sumOf(const std::vector<ClearFigures>& parts) {
  ClearFigures sum;
  for (const ClearFigures& p : parts) addClear(p, sum);
  return sum;
}

// Share of the objects with a k-th measurement that then have an output of the right class.
std::optional<double> rightShare(const LabelScore& score, std::size_t k, int label = -1) {
  std::size_t objects = 0, right = 0;
  for (std::size_t l = 0; l < score.objects.size(); ++l) {
    if (label >= 0 && l != static_cast<std::size_t>(label)) continue;
    objects += score.objects[l][k - 1];
    right += score.right[l][k - 1];
  }
  if (objects == 0) return {};
  return static_cast<double>(right) / static_cast<double>(objects);
}

std::string percent(const std::optional<double>& value) {
  return value ? fmt::format("{:.1f}", 100 * *value) : "n/a";
}

using Row = std::vector<std::string>;

// A table with a row a condition: labels, method, and what `fill` adds.
StudyTable conditionsTable(const char* name, const char* title, const Row& figures,
                           const std::vector<LabelCondition>& conditions,
                           const std::function<void(const LabelCondition&, Row&)>& fill) {
  StudyTable table;
  table.name = name;
  table.title = title;
  table.columns = {"labels", "method"};
  table.columns.insert(table.columns.end(), figures.begin(), figures.end());
  for (const LabelCondition& c : conditions) {
    Row row = {c.labels(), c.method.name};
    fill(c, row);
    table.rows.push_back(std::move(row));
  }
  return table;
}

StudyTable figuresTable(const std::vector<LabelCondition>& conditions, const LabelsParams& params) {
  const Row figures = {"MOTA by class (%)",
                       "missed",
                       "false",
                       "id switches",
                       "MOTA, whatever class (%)",
                       "id switches, whatever class",
                       "right class after 1 (%)",
                       "after 3 (%)",
                       "after 10 (%)",
                       "after 30 (%)"};
  return conditionsTable(
      "labels", "Tracking by what the detector says of the class", figures, conditions,
      [&](const LabelCondition& c, Row& row) {
        const ClearFigures by_class = sumOf(c.score.of_class);
        row.push_back(percent(by_class.mota));
        for (const auto count : {by_class.misses, by_class.false_objects, by_class.id_switches})
          row.push_back(fmt::format("{}", count));
        row.push_back(percent(c.score.any_class.mota));
        row.push_back(fmt::format("{}", c.score.any_class.id_switches));
        for (const int k : {1, 3, 10, 30}) {
          row.push_back(k <= params.last_measurement
                            ? percent(rightShare(c.score, static_cast<std::size_t>(k)))
                            : "n/a");
        }
      });
}

StudyTable classTable(const std::vector<LabelCondition>& conditions, const LabelsParams& params) {
  Row figures;
  for (const std::string& label : params.labels) {
    for (const char* figure : {"MOTA (%)", "id switches", "right after 10 (%)"})
      figures.push_back(label + ": " + figure);
  }
  return conditionsTable(
      "labels_by_class", "The same by class", figures, conditions,
      [&](const LabelCondition& c, Row& row) {
        for (std::size_t l = 0; l < params.labels.size(); ++l) {
          row.push_back(percent(c.score.of_class[l].mota));
          row.push_back(fmt::format("{}", c.score.of_class[l].id_switches));
          row.push_back(params.last_measurement >= 10
                            ? percent(rightShare(c.score, 10, static_cast<int>(l)))
                            : "n/a");
        }
      });
}

StudyTable curveTable(const std::vector<LabelCondition>& conditions, const LabelsParams& params) {
  Row figures, counts = {"(objects that had one)", ""};
  std::vector<std::size_t> numbers;
  for (const std::size_t k : {1, 2, 3, 4, 5, 7, 10, 15, 20, 30, 40}) {
    if (k > static_cast<std::size_t>(params.last_measurement)) continue;
    numbers.push_back(k);
    figures.push_back(fmt::format("{}", k));
    std::size_t n = 0;
    for (const auto& objects : conditions.front().score.objects) n += objects[k - 1];
    counts.push_back(fmt::format("{}", n));
  }
  StudyTable table = conditionsTable(
      "right_class",
      "Share of objects (%) that have an output of the right class at their k-th measurement",
      figures, conditions, [&](const LabelCondition& c, Row& row) {
        for (const std::size_t k : numbers) row.push_back(percent(rightShare(c.score, k)));
      });
  table.rows.insert(table.rows.begin(), std::move(counts));
  return table;
}

// What a line of the pictures is of, and how it looks.
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
// switches whatever class, right after 10.
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
    // Pooled without labels stands behind a gap: 100 %, drawn at 70.
    text += fmt::format("{:.0f} {} {} {} {}\n",
                        c.damage.probability >= 1 ? 70 : 100 * c.damage.probability,
                        percent(by_class.mota), percent(c.score.any_class.mota),
                        c.score.any_class.id_switches, percent(rightShare(c.score, k)));
  }
  return text;
}

// A row of the picture: one figure, a column of the points.
struct Panel {
  const char* label;
  const char* range;
  int column;
};
constexpr Panel kPanels[] = {{"MOTA by class (%)", "[*:100]", 2},
                             {"MOTA, whatever class (%)", "[*:100]", 3},
                             {"identity switches", "[0:*]", 4},
                             {"right class after 10 (%)", "[0:100]", 5}};

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

}  // namespace

std::string LabelCondition::labels() const {
  if (damage.kind == LabelNoise::kNone) return "as they are";
  if (damage.kind == LabelNoise::kDropped && damage.probability >= 1) return "none, pooled";
  return fmt::format("{:.0f} % {}", 100 * damage.probability,
                     damage.kind == LabelNoise::kDropped ? "dropped" : "flipped");
}

void addClear(const ClearFigures& part, ClearFigures& sum) {
  sum.truth += part.truth;
  sum.misses += part.misses;
  sum.false_objects += part.false_objects;
  sum.id_switches += part.id_switches;
  sum.setMota();
}

void describeLabels(const LabelsParams& params, const std::vector<LabelCondition>& conditions,
                    const std::string& where, StudyReport& report) {
  report.tables = {figuresTable(conditions, params), classTable(conditions, params),
                   curveTable(conditions, params)};
  report.plots = {figuresPlot(conditions, where), curvePlot(conditions, params, where)};
  report.remarks = {
      fmt::format(
          "Labels are corrupted per thing and frame, independently: boxes of different labels "
          "within {:g} m are of one thing, and one that is hit keeps its surest box with "
          "place, size and score. Dropped: the box says '{}'; flipped: one of the other "
          "labels, each alike. Real detectors err alike for seconds: these figures are the "
          "kind side of the question.",
          params.group_distance, kNoLabel),
      "Tracker per class: the same pipeline and motion models once per label, on that label's "
      "boxes "
      "only, outputs joined, each of its tracker's class. Boxes without a label are left out, or "
      "given to every tracker (unlabeled to all).",
      fmt::format("Put out is what exists and is a road user with a probability of {:g} or more. "
                  "Matching one-to-one within {:g} m on the ground; truth within {:g} m and {:g} "
                  "deg; outputs on truth that does not count are neither right nor wrong. KITTI's "
                  "DontCare areas have no place on the ground: outputs there count as false, for "
                  "all methods alike.",
                  params.least_output, params.evaluation.tolerance,
                  params.evaluation.selection.range, degrees(params.evaluation.selection.fov)),
      "MOTA by class: outputs of a class against objects of that class, errors summed over the "
      "classes (a wrong class is a miss and a false object). Whatever class: one output an object; "
      "a second one is false.",
      "k-th measurement: the k-th frame in which some box, of whatever label and score, lies on "
      "the object before labels are corrupted; the same instants for all methods. An object "
      "without "
      "an output has no right class."};
}

}  // namespace perception
