#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "libperception/core/math/Median.h"
#include "libperception/evaluation/plots/Gnuplot.h"
#include "libperception/evaluation/plots/RunPlots.h"

namespace perception {
namespace {

constexpr std::size_t kMaxTruthRows = 60;  // limit of legible rows
constexpr std::size_t kMaxFalseRows = 25;

constexpr const char* kHead = R"(
set title {title} noenhanced font ',13'
unset key
unset ytics
set grid noytics
set lmargin {margin}
set bmargin 5
set xrange [{from:.3f}:{to:.3f}]
set yrange [{bottom:.2f}:-1]
set xlabel 'time since the log''s first stamp (s)' offset 0,0.5
set style fill solid 1 noborder
)";

// Estimated class of an object over a time interval.
struct Stretch {
  double from, to;  // [s]
  double row;
  int state;  // 2 * class + classified; -1 missed
};

// Median time between two instants [s]: width of a single one in the plot.
double typicalStep(const std::vector<InstantFigures>& instants) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < instants.size(); ++i)
    steps.push_back(instants[i].t - instants[i - 1].t);
  return steps.empty() ? 0.1 : std::max(medianOf(std::move(steps)), 1e-3);
}

// Joins consecutive instants of one row and state to intervals.
class Stretches {
 public:
  explicit Stretches(double step) : step_(step) {}

  void add(double row, std::size_t instant, double t, int state) {
    const auto open = open_.find(row);
    if (open != open_.end()) {
      Stretch& s = done_[open->second.second];
      if (open->second.first + 1 == instant && s.state == state) {
        s.to = t + step_;
        open->second.first = instant;
        return;
      }
      // No gap where only the state changed.
      if (open->second.first + 1 == instant) s.to = t;
    }
    done_.push_back({t, t + step_, row, state});
    open_[row] = {instant, done_.size() - 1};
  }

  std::string rows(int state) const {
    std::string text;
    for (const Stretch& s : done_) {
      if (s.state == state) text += fmt::format("{:.3f} {:.3f} {:.2f}\n", s.from, s.to, s.row);
    }
    return text;
  }

 private:
  double step_;
  std::vector<Stretch> done_;
  std::map<double, std::pair<std::size_t, std::size_t>> open_;  // row -> last instant, stretch
};

// Builds the picture of one run.
class TimelinePlot {
 public:
  TimelinePlot(const EvaluatedRun& run, const EvaluationOptions& options, PlotScript& script)
      : run_(run),
        evaluation_(run.evaluation),
        options_(options),
        script_(script),
        stretches_(typicalStep(run.evaluation.instants)) {}

  void draw() {
    if (evaluation_.instants.empty()) return;
    addTruth();
    addFalse();
    const double bottom = next_row_ + 0.2;
    const std::size_t height = 170 + static_cast<std::size_t>(20 * (bottom + 1));
    script_.begin("timelines.png", 1300, height);
    const auto& instants = evaluation_.instants;
    const double from = instants.front().t, to = instants.back().t;
    script_.add(fmt::format(kHead, fmt::arg("title", gnuplotString(title())),
                            fmt::arg("margin", 24), fmt::arg("from", from),
                            fmt::arg("to", to + 0.01 * (to - from) + 0.1),
                            fmt::arg("bottom", bottom)));
    script_.add(labels_);
    addLegend(22 / static_cast<double>(height));
    addPlot();
  }

 private:
  std::string title() const {
    return fmt::format(
        "What every true object was called, {} (within {:g} m and {:g} deg ahead; one-to-one "
        "within {:g} m)",
        run_.name, options_.selection.range, degrees(options_.selection.fov), options_.tolerance);
  }

  void label(double row, const std::string& text, const std::string& color) {
    labels_ += fmt::format(
        "set label {} at graph -0.008, first {:.2f} right noenhanced textcolor rgb '{}'\n",
        gnuplotString(text), row, color);
  }

  std::string classColor(ClassId c) const {
    return hexOf(colorOfClass(evaluation_.class_names[static_cast<std::size_t>(c)], c));
  }

  void addTruth() {
    std::vector<ObjectTimeline> lines = objectTimelines(evaluation_, Pairing::kOneToOne);
    const std::size_t all = lines.size();
    std::stable_sort(lines.begin(), lines.end(),
                     [](const auto& a, const auto& b) { return a.active > b.active; });
    if (lines.size() > kMaxTruthRows) lines.resize(kMaxTruthRows);
    std::stable_sort(lines.begin(), lines.end(),
                     [](const auto& a, const auto& b) { return a.first_active < b.first_active; });
    std::map<std::int64_t, double> row_of;
    for (const ObjectTimeline& line : lines) {
      row_of[line.id] = next_row_;
      label(next_row_, fmt::format("{} {}", line.type, line.id), classColor(line.class_id));
      next_row_ += 1;
    }
    std::map<std::int64_t, std::uint64_t> last_id;
    for (const TruthSample& s : evaluation_.samples) {
      const auto row = row_of.find(s.id);
      if (row == row_of.end()) continue;
      const auto& m = s.matched(Pairing::kOneToOne);
      stretches_.add(row->second, s.instant, s.t,
                     m ? 2 * m->class_id + (m->classified ? 1 : 0) : -1);
      if (!m) continue;
      const auto last = last_id.find(s.id);
      if (last != last_id.end() && last->second != m->id)
        switches_ += fmt::format("{:.3f} {:.2f}\n", s.t, row->second);
      last_id[s.id] = m->id;
    }
    if (all > lines.size()) {
      label(next_row_, fmt::format("and {} shorter ones", all - lines.size()), "black");
      next_row_ += 1;
    }
  }

  void addFalse() {
    std::map<std::uint64_t, std::size_t> count;
    for (const InstantFigures& instant : evaluation_.instants) {
      for (const FalseObject& f : instant.false_objects) ++count[f.id];
    }
    next_row_ += 0.5;
    labels_ += fmt::format(
        "set arrow from graph 0, first {0:.2f} to graph 1, first {0:.2f} nohead lc rgb 'black'\n",
        next_row_ - 0.5);
    std::vector<std::pair<std::uint64_t, std::size_t>> longest(count.begin(), count.end());
    std::stable_sort(longest.begin(), longest.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    const std::size_t all = longest.size();
    if (longest.size() > kMaxFalseRows) longest.resize(kMaxFalseRows);
    std::map<std::uint64_t, double> row_of;
    for (const auto& entry : longest) {
      row_of[entry.first] = next_row_;
      label(next_row_, fmt::format("false, id {}", entry.first), "black");
      next_row_ += 1;
    }
    for (std::size_t i = 0; i < evaluation_.instants.size(); ++i) {
      for (const FalseObject& f : evaluation_.instants[i].false_objects) {
        const auto row = row_of.find(f.id);
        if (row == row_of.end()) continue;
        stretches_.add(row->second, i, evaluation_.instants[i].t,
                       2 * f.class_id + (f.classified ? 1 : 0));
      }
    }
    if (all == 0) label(next_row_, "no false objects", "black");
    if (all > longest.size())
      label(next_row_, fmt::format("and {} shorter ones", all - longest.size()), "black");
    if (all == 0 || all > longest.size()) next_row_ += 1;
  }

  // Colors that occur, below the axis; `y` in shares of the picture.
  void addLegend(double y) {
    double x = 0.02;
    for (std::size_t c = 0; c < evaluation_.class_names.size(); ++c) {
      const auto k = static_cast<ClassId>(c);
      if (stretches_.rows(2 * k).empty() && stretches_.rows(2 * k + 1).empty()) continue;
      const std::string& name = evaluation_.class_names[c];
      script_.add(fmt::format(
          "set label {} at screen {:.3f}, screen {:.4f} left noenhanced point pt 5 ps 1.6 lc rgb "
          "'{}' offset 1.2,0\n",
          gnuplotString(name), x, y, classColor(k)));
      x += 0.025 + 0.0075 * static_cast<double>(name.size());
    }
    script_.add(fmt::format(
        "set label 'pale: most probable, below .95   thin line: missed   black mark: another id   "
        "names have the color of the true class' at screen {:.3f}, screen {:.4f} left\n",
        x + 0.01, y));
  }

  void addPlot() {
    std::string plot;
    const auto add = [&](const std::string& file, const std::string& rows, const std::string& how) {
      if (rows.empty()) return;
      script_.data(file, rows);
      plot += fmt::format("{}'{}' {}", plot.empty() ? "plot " : ", \\\n ", file, how);
    };
    const std::string bar =
        "using (($1+$2)/2):3:1:2:($3-{0}):($3+{0}) with boxxyerror lc rgb '{1}'";
    add("timelines_missed.dat", stretches_.rows(-1),
        "using 1:3:($2-$1):(0) with vectors nohead lw 1.5 lc rgb '#555555'");
    for (std::size_t c = 0; c < evaluation_.class_names.size(); ++c) {
      const auto k = static_cast<ClassId>(c);
      const std::string color = classColor(k);
      // Two hex digits in front are the transparency.
      add(fmt::format("timelines_{}_unsure.dat", c), stretches_.rows(2 * k),
          fmt::format(bar, 0.36, "#A0" + color.substr(1)));
      add(fmt::format("timelines_{}.dat", c), stretches_.rows(2 * k + 1),
          fmt::format(bar, 0.36, color));
    }
    add("timelines_switches.dat", switches_,
        "using 1:($2-0.5):(0):(1) with vectors nohead lw 3 lc rgb 'black'");
    if (plot.empty()) plot = "plot NaN";
    script_.add(plot + "\nunset output\n");
  }

  const EvaluatedRun& run_;
  const Evaluation& evaluation_;
  const EvaluationOptions& options_;
  PlotScript& script_;
  Stretches stretches_;
  double next_row_ = 0;
  std::string labels_, switches_;
};

}  // namespace

void drawTimelines(const EvaluatedRun& run, const EvaluationOptions& options, PlotScript& script) {
  TimelinePlot(run, options, script).draw();
}

}  // namespace perception
