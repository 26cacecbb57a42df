#include "libperception/evaluation/Plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <system_error>

#include "libperception/core/Error.h"
#include "libperception/evaluation/Gnuplot.h"
#include "libperception/scene/OutputFile.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMinSamples = 5;        // fewer instants are no curve
constexpr std::size_t kMaxOverviewRows = 60;  // more names cannot be read
constexpr std::size_t kMaxNamedIds = 8;       // ids with a colour and a line in the legend

// Colours that people with colour-blindness can tell apart (Okabe and Ito).
constexpr const char* kGreen = "#009E73";
constexpr const char* kOrange = "#E69F00";
constexpr const char* kRed = "#C00000";
constexpr const char* kBlue = "#0072B2";
constexpr const char* kGrey = "#BBBBBB";
constexpr const char* kIdColours[kMaxNamedIds] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                  "#E69F00", "#56B4E9", "#8B4513", "#F0E442"};

// How every picture begins: nothing of the one before is left.
constexpr const char* kPicture = R"(
reset
set encoding utf8
set datafile missing 'nan'
set terminal pngcairo size {width},{height} font 'sans,10' background rgb 'white'
set output '{file}'
set grid xtics ytics lt 1 lw 1 lc rgb '#DDDDDD'
set key noenhanced outside right top vertical Left reverse
)";

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
plot 'overview_objects.dat' using 1:($3==0?$2:1/0) with points pt 5 ps 0.9 lc rgb '{grey}' title 'not tracked', \
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

constexpr const char* kReliability = R"(
set title {title} noenhanced font ',12'
set size square
set key inside bottom right
set xrange [0:1.05]
set yrange [0:1.05]
set xlabel 'stated probability of the most probable class'
set ylabel 'share of instants at which that class is right'
plot x with lines dt 2 lw 2 lc rgb 'black' title 'right as often as stated', \
 'reliability.dat' using 1:2 with linespoints pt 7 ps 1.5 lw 2 lc rgb '{blue}' title 'this run, with number of instants', \
 '' using 1:2:(sprintf('%d', $3)) with labels offset -1,-1.2 notitle
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
set ylabel 'bearing of centre (deg, left is +)'
set yrange [*:*]
plot {bearing}
unset multiplot
unset output
)";

std::string objectName(const ObjectTimeline& o) { return fmt::format("{} {}", o.type, o.id); }

// The files of one folder of plots and the script that draws them.
class PlotWriter {
 public:
  PlotWriter(const EvaluatedRun& run, const EvaluationOptions& options, std::string dir)
      : run_(run),
        options_(options),
        dir_(std::move(dir)),
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
    data("overview_objects.dat", objectRows(row_of));
    data("overview_instants.dat", instantRows());
    const std::size_t height = 400 + 22 * std::max<std::size_t>(rows.size(), 3);
    const double pixel = 1 / static_cast<double>(height);
    const double split = 250 * pixel;  // the lower panel keeps its height
    begin("overview.png", 1200, height);
    script_ += fmt::format(
        kOverviewHead,
        fmt::arg("title", gnuplotString("Tracking of every truth object, " + run_.name)),
        fmt::arg("from", instants.front().t - 0.2), fmt::arg("to", instants.back().t + 0.2));
    if (!rows.empty()) {
      script_ += fmt::format(
          kOverviewObjects, fmt::arg("size", 1 - split - 30 * pixel), fmt::arg("bottom", split),
          fmt::arg("title", gnuplotString(overviewScope(rows.size()))), fmt::arg("names", names),
          fmt::arg("rows", rows.size()), fmt::arg("grey", kGrey), fmt::arg("green", kGreen),
          fmt::arg("orange", kOrange), fmt::arg("red", kRed));
    }
    script_ += fmt::format(kOverviewInstants, fmt::arg("size", split), fmt::arg("orange", kOrange),
                           fmt::arg("blue", kBlue));
  }

  void reliabilityPlot() {
    const Reliability r = reliability(run_.evaluation, Pairing::kOneToOne);
    if (!r.calibration_error) return;
    std::string rows = "# mean stated probability, share correct, instants\n";
    for (const ReliabilityBin& bin : r.bins) {
      if (bin.count == 0) continue;
      rows += fmt::format("{:.6f} {:.6f} {}\n", *bin.mean_probability, *bin.correct, bin.count);
    }
    data("reliability.dat", rows);
    begin("reliability.png", 760, 760);
    const std::string title =
        fmt::format("Reliability of the class probability, {} (mean |stated - right| {:.3f})",
                    run_.name, *r.calibration_error);
    script_ +=
        fmt::format(kReliability, fmt::arg("title", gnuplotString(title)), fmt::arg("blue", kBlue));
  }

  void object(const ObjectTimeline& o) {
    const std::string name = fmt::format("object_{}", o.id);
    data(name + ".dat", objectCurves(o));
    begin(name + ".png", 1000, 700);
    const std::string title = fmt::format("{}, {}: tracked at {} of {} instants", objectName(o),
                                          run_.name, o.returns, o.active);
    script_ +=
        fmt::format(kObject, fmt::arg("title", gnuplotString(title)),
                    fmt::arg("from", o.first_active - 0.2), fmt::arg("to", o.last_active + 0.2),
                    fmt::arg("range", curves(name, 2, o)), fmt::arg("bearing", curves(name, 3, o)));
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

  PlotResult draw() {
    data("plots.gp", script_);
    PlotResult result;
    result.fault = runGnuplot(dir_, "plots.gp");
    for (const std::string& file : files_) {
      std::error_code ignored;
      if (fs::exists(dir_ + "/" + file, ignored)) result.files.push_back("plots/" + file);
    }
    return result;
  }

 private:
  void data(const std::string& name, const std::string& text) const {
    writeFile(dir_ + "/" + name, text);
  }

  void begin(const std::string& file, std::size_t width, std::size_t height) {
    files_.push_back(file);
    script_ += fmt::format(kPicture, fmt::arg("width", width), fmt::arg("height", height),
                           fmt::arg("file", file));
  }

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
      // A blank line lifts the pen where the object does not count.
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
                          i + 1, column, i < kMaxNamedIds ? kIdColours[i] : kGrey);
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
  std::string dir_, script_;
  std::vector<ObjectTimeline> timelines_;
  std::vector<std::string> files_;
};

// Pictures of an earlier evaluation would be taken for this one's.
void removeOldPictures(const std::string& dir) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(dir, ignored)) {
    const std::string name = entry.path().filename().string();
    const bool ours =
        name == "overview.png" || name == "reliability.png" || name.rfind("object_", 0) == 0;
    if (ours) fs::remove(entry.path(), ignored);
  }
}

}  // namespace

PlotResult writePlots(const EvaluatedRun& run, const EvaluationOptions& options,
                      const std::string& dir, std::size_t max_objects) {
  const std::string plots = dir + "/plots";
  std::error_code failed;
  fs::create_directories(plots, failed);
  if (failed) throw OutputError(fmt::format("{}: cannot be created: {}", plots, failed.message()));
  removeOldPictures(plots);
  PlotWriter writer(run, options, plots);
  writer.overview();
  writer.reliabilityPlot();
  for (const ObjectTimeline* object : writer.longest(max_objects)) {
    if (object->active >= kMinSamples) writer.object(*object);
  }
  return writer.draw();
}

}  // namespace perception
