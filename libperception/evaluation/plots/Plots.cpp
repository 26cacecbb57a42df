#include "libperception/evaluation/plots/Plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "libperception/evaluation/plots/Gnuplot.h"
#include "libperception/evaluation/plots/RunPlots.h"

namespace perception {
namespace {

using namespace plot_color;

constexpr std::size_t kMinSamples = 5;        // fewest instants of a curve
constexpr std::size_t kMaxOverviewRows = 60;  // limit of legible rows
constexpr std::size_t kMaxNamedIds = 7;       // ids with a line in the legend; black is the truth's

constexpr const char* kOverviewHead = R"(
set multiplot title {title} noenhanced font ',14'
set xrange [{from:.3f}:{to:.3f}]
set lmargin 16
set rmargin 30
)";

constexpr const char* kOverviewObjects = R"(
set size 1,{size:.4f}
set origin 0,{bottom:.4f}
set tmargin 2
set bmargin 1
set title {title} noenhanced
set format x ''
set ytics noenhanced ({names})
set yrange [{rows}:-1]
plot 'overview_objects.dat' using 1:($3==0?$2:1/0) with points pt 5 ps 0.9 lc rgb '{gray}' title 'not tracked', \
 '' using 1:($3==1?$2:1/0) with points pt 5 ps 0.9 lc rgb '{green}' title 'tracked, class correct', \
 '' using 1:($3==2?$2:1/0) with points pt 5 ps 0.9 lc rgb '{orange}' title 'tracked, not classified', \
 '' using 1:($3==3?$2:1/0) with points pt 5 ps 0.9 lc rgb '{red}' title 'tracked, class wrong', \
 '' using 1:($4==1?$2:1/0) with points pt 2 ps 1.3 lw 2 lc rgb 'black' title 'id switch'
)";

constexpr const char* kOverviewInstants = R"(
set size 1,{size:.4f}
set origin 0,0
set tmargin 2
set bmargin 4
set title 'Number of objects at each instant'
set format x '%g'
set xlabel 'time since the log''s first stamp (s)'
set ylabel 'number'
set ytics autofreq
set yrange [0:*]
plot 'overview_instants.dat' using 1:2 with steps lw 2 lc rgb 'black' title 'truth objects', \
 '' using 1:3 with steps lw 2 lc rgb '{orange}' title 'of these not tracked', \
 '' using 1:4 with steps lw 2 lc rgb '{blue}' title 'false objects'
unset multiplot
unset output
)";

constexpr const char* kObject = R"(
set multiplot layout 2,1 title {title} noenhanced font ',14'
set lmargin 10
set rmargin 24
set xrange [{from:.3f}:{to:.3f}]
set ylabel 'range to closest point (m)'
set yrange [0:*]
plot {range}
set xlabel 'time since the log''s first stamp (s)'
set ylabel 'bearing of center (deg, left is +)'
set yrange [*:*]
plot {bearing}
unset multiplot
unset output
)";

std::string objectName(const ObjectTimeline& o) { return fmt::format("{} {}", o.type, o.id); }

// The files of one folder of plots and the script that draws them.
class PlotWriter {
 public:
  PlotWriter(const EvaluatedRun& run, const EvaluationOptions& options, PlotScript& script)
      : run_(run),
        options_(options),
        script_(script),
        timelines_(objectTimelines(run.evaluation, Pairing::kOneToOne)) {}

  void overview() {
    const auto& instants = run_.evaluation.instants;
    if (instants.empty()) return;
    const std::vector<const ObjectTimeline*> rows = longest(kMaxOverviewRows);
    std::map<std::int64_t, std::size_t> row_of;
    std::string names;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      row_of[rows[r]->id] = r;
      names += fmt::format("{}{} {}", r ? ", " : "", gnuplotString(objectName(*rows[r])), r);
    }
    script_.data("overview_objects.dat", objectRows(row_of));
    script_.data("overview_instants.dat", instantRows());
    const std::size_t height = 400 + 22 * std::max<std::size_t>(rows.size(), 3);
    const double pixel = 1 / static_cast<double>(height);
    const double split = 250 * pixel;  // the lower panel keeps its height
    script_.begin("overview.png", 1200, height);
    script_.add(fmt::format(
        kOverviewHead,
        fmt::arg("title", gnuplotString("Tracking of every truth object, " + run_.name)),
        fmt::arg("from", instants.front().t - 0.2), fmt::arg("to", instants.back().t + 0.2)));
    if (!rows.empty()) {
      script_.add(fmt::format(
          kOverviewObjects, fmt::arg("size", 1 - split - 30 * pixel), fmt::arg("bottom", split),
          fmt::arg("title", gnuplotString(overviewScope(rows.size()))), fmt::arg("names", names),
          fmt::arg("rows", rows.size()), fmt::arg("gray", kGray), fmt::arg("green", kGreen),
          fmt::arg("orange", kOrange), fmt::arg("red", kRed)));
    }
    script_.add(fmt::format(kOverviewInstants, fmt::arg("size", split), fmt::arg("orange", kOrange),
                            fmt::arg("blue", kBlue)));
  }

  void object(const ObjectTimeline& o) {
    const std::string name = fmt::format("object_{}", o.id);
    script_.data(name + ".dat", objectCurves(o));
    script_.begin(name + ".png", 1000, 700);
    const std::string title = fmt::format("{}, {}: tracked at {} of {} instants", objectName(o),
                                          run_.name, o.returns, o.active);
    script_.add(fmt::format(
        kObject, fmt::arg("title", gnuplotString(title)), fmt::arg("from", o.first_active - 0.2),
        fmt::arg("to", o.last_active + 0.2), fmt::arg("range", curves(name, 2, o)),
        fmt::arg("bearing", curves(name, 3, o))));
  }

  std::vector<const ObjectTimeline*> longest(std::size_t count) const {
    std::vector<const ObjectTimeline*> objects;
    for (const ObjectTimeline& o : timelines_) objects.push_back(&o);
    std::stable_sort(objects.begin(), objects.end(),
                     [](auto* a, auto* b) { return a->active > b->active; });
    if (objects.size() > count) objects.resize(count);
    std::stable_sort(objects.begin(), objects.end(),
                     [](auto* a, auto* b) { return a->first_active < b->first_active; });
    return objects;
  }

 private:
  std::string overviewScope(std::size_t rows) const {
    const std::string some = rows < timelines_.size()
                                 ? fmt::format(", the longest {} of {}", rows, timelines_.size())
                                 : "";
    return fmt::format("within {:g} m and {:g} deg ahead, one-to-one matching within {:g} m{}",
                       options_.selection.range, degrees(options_.selection.fov),
                       options_.tolerance, some);
  }

  // The truth as the first block, then one block for each id that tracked it.
  std::string objectCurves(const ObjectTimeline& o) const {
    std::map<std::uint64_t, std::string> estimates;
    std::string text = "# t [s], range to the closest point [m], bearing [deg]\n";
    std::size_t last_instant = 0;
    for (const TruthSample& s : run_.evaluation.samples) {
      if (s.id != o.id) continue;
      // A blank line interrupts the curve where the object does not count.
      if (s.instant > last_instant + 1) text += "\n";
      last_instant = s.instant;
      text += polar(s.t, s.view);
      if (const auto& m = s.matched(Pairing::kOneToOne)) estimates[m->id] += polar(s.t, m->view);
    }
    for (const std::uint64_t id : o.ids) {
      text += fmt::format("\n\n# estimate with id {}\n{}", id, estimates[id]);
    }
    return text;
  }

  static std::string polar(double t, const GroundView& view) {
    return fmt::format("{:.3f} {:.4f} {:.4f}\n", t, view.closest_range, degrees(view.bearing));
  }

  std::string curves(const std::string& name, int column, const ObjectTimeline& o) const {
    std::string plot = fmt::format(
        "'{}.dat' index 0 using 1:{} with lines lw 3 lc rgb 'black' title 'truth'", name, column);
    for (std::size_t i = 0; i < o.ids.size(); ++i) {
      plot += fmt::format(", \\\n '' index {} using 1:{} with points pt 7 ps 0.8 lc rgb '{}' ",
                          i + 1, column, i < kMaxNamedIds ? ofRun(i) : kGray);
      if (i < kMaxNamedIds) {
        plot += fmt::format("title 'estimate, id {}'", o.ids[i]);
      } else {
        plot += i == kMaxNamedIds ? "title 'further ids'" : "notitle";
      }
    }
    return plot;
  }

  // t, row, state (0 not tracked, 1 correct, 2 not classified, 3 wrong), id switch
  std::string objectRows(const std::map<std::int64_t, std::size_t>& row_of) const {
    std::string text =
        "# t [s], row, state (0 not tracked, 1 correct, 2 not classified, 3 wrong), id switch\n";
    std::map<std::int64_t, std::uint64_t> last_id;
    for (const TruthSample& s : run_.evaluation.samples) {
      const auto row = row_of.find(s.id);
      if (row == row_of.end()) continue;
      const auto& m = s.matched(Pairing::kOneToOne);
      int state = 0;
      bool switched = false;
      if (m) {
        state = !m->classified ? 2 : m->class_id == s.class_id ? 1 : 3;
        const auto last = last_id.find(s.id);
        switched = last != last_id.end() && last->second != m->id;
        last_id[s.id] = m->id;
      }
      text += fmt::format("{:.3f} {} {} {}\n", s.t, row->second, state, switched ? 1 : 0);
    }
    return text;
  }

  std::string instantRows() const {
    std::vector<std::size_t> tracked(run_.evaluation.instants.size());
    for (const TruthSample& s : run_.evaluation.samples) {
      if (s.matched(Pairing::kOneToOne)) ++tracked[s.instant];
    }
    std::string text = "# t [s], truth objects that count, of these not tracked, false objects\n";
    for (std::size_t i = 0; i < tracked.size(); ++i) {
      const InstantFigures& instant = run_.evaluation.instants[i];
      text += fmt::format("{:.3f} {} {} {}\n", instant.t, instant.truth, instant.truth - tracked[i],
                          instant.allOutputs().false_);
    }
    return text;
  }

  const EvaluatedRun& run_;
  const EvaluationOptions& options_;
  PlotScript& script_;
  std::vector<ObjectTimeline> timelines_;
};

}  // namespace

PlotResult writePlots(const EvaluatedRun& run, const EvaluationOptions& options,
                      const std::string& dir, std::size_t max_objects) {
  PlotScript script(dir);
  PlotWriter writer(run, options, script);
  drawTimelines(run, options, script);
  writer.overview();
  drawSetDistance({&run}, options, script);
  drawReliability({&run}, false, script);
  drawReliability({&run}, true, script);
  for (const ObjectTimeline* object : writer.longest(max_objects)) {
    if (object->active >= kMinSamples) writer.object(*object);
  }
  return script.draw();
}

PlotResult writeComparisonPlots(const EvaluationReport& report, const std::string& dir) {
  PlotScript script(dir);
  std::vector<const EvaluatedRun*> runs;
  bool single = true;
  for (const EvaluatedRun& run : report.runs) {
    runs.push_back(&run);
    single = single && run.trials.empty();
  }
  drawComparison(report, script);
  // Trials of different logs have no common time.
  if (single) drawSetDistance(runs, report.options, script);
  drawReliability(runs, false, script);
  drawReliability(runs, true, script);
  return script.draw();
}

}  // namespace perception
