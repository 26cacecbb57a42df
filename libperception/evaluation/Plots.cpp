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
constexpr const char* kRed = "#D55E00";
constexpr const char* kBlue = "#0072B2";
constexpr const char* kGrey = "#BBBBBB";
constexpr const char* kIdColours[kMaxNamedIds] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                  "#E69F00", "#56B4E9", "#8B4513", "#F0E442"};

// How every picture begins.
constexpr const char* kPreamble =
    "set encoding utf8\nset datafile missing 'nan'\nset key noenhanced\nset grid lc rgb "
    "'#E0E0E0'\n";

std::string objectName(const ObjectTimeline& o) { return fmt::format("{} {}", o.type, o.id); }

// The files of one folder of plots and the script that draws them.
class PlotWriter {
 public:
  PlotWriter(const EvaluatedRun& run, const EvaluationOptions& options, std::string dir)
      : run_(run),
        options_(options),
        dir_(std::move(dir)),
        timelines_(objectTimelines(run.evaluation, Pairing::kOneToOne)) {
    script_ = kPreamble;
  }

  void overview() {
    if (run_.evaluation.instants.empty()) return;
    const std::vector<const ObjectTimeline*> rows = longest(kMaxOverviewRows);
    std::map<std::int64_t, std::size_t> row_of;
    std::string names;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      row_of[rows[r]->id] = r;
      names += fmt::format("{}{} {}", r ? ", " : "", gnuplotString(objectName(*rows[r])), r);
    }
    data("overview_objects.dat", objectRows(row_of));
    data("overview_instants.dat", instantRows());
    const std::size_t height = 420 + 22 * rows.size();
    begin("overview.png", 1200, height);
    const double split = 250.0 / static_cast<double>(height);  // the lower panel keeps its height
    const std::string objects =
        rows.size() < timelines_.size()
            ? fmt::format(" (the longest {} of {})", rows.size(), timelines_.size())
            : "";
    script_ += fmt::format("set multiplot title {} noenhanced font ',14'\n",
                           gnuplotString("Tracking of every truth object: " + run_.name));
    script_ += timeRange() + "set lmargin 16\nset rmargin 3\n";
    if (!rows.empty()) {
      script_ +=
          fmt::format("set size 1,{0:.4f}\nset origin 0,{1:.4f}\nset tmargin 5\nset bmargin 1.5\n",
                      1 - split - 25.0 / static_cast<double>(height), split);
      script_ += fmt::format(
          "set title {} noenhanced\nset key outside top center horizontal\nset format x ''\nunset "
          "xlabel\n",
          gnuplotString(
              fmt::format("within {:g} m and {:g} deg ahead, one-to-one matching within {:g} m{}",
                          options_.selection.range, degrees(options_.selection.fov),
                          options_.tolerance, objects)));
      script_ +=
          fmt::format("set ytics noenhanced ({})\nset yrange [{}:-1] \n", names, rows.size());
      script_ += fmt::format(
          "plot 'overview_objects.dat' using 1:($3==0?$2:1/0) with points pt 5 ps 0.6 lc rgb '{}' "
          "title 'not tracked', \\\n"
          " '' using 1:($3==1?$2:1/0) with points pt 5 ps 0.9 lc rgb '{}' title 'tracked, class "
          "correct', \\\n"
          " '' using 1:($3==2?$2:1/0) with points pt 5 ps 0.9 lc rgb '{}' title 'tracked, not "
          "classified', \\\n"
          " '' using 1:($3==3?$2:1/0) with points pt 5 ps 0.9 lc rgb '{}' title 'tracked, class "
          "wrong', \\\n"
          " '' using 1:($4==1?$2:1/0) with points pt 2 ps 1.3 lw 2 lc rgb 'black' title 'id "
          "switch'\n",
          kGrey, kGreen, kOrange, kRed);
    }
    script_ +=
        fmt::format("set size 1,{:.4f}\nset origin 0,0\nset tmargin 3\nset bmargin 4\n", split);
    script_ +=
        "set title 'Objects at each instant'\nset key outside top right horizontal\nset format x "
        "'%g'\nset xlabel 'time since the log''s first stamp (s)'\n"
        "set ylabel 'number'\nset ytics autofreq\nset yrange [0:*]\n";
    script_ += fmt::format(
        "plot 'overview_instants.dat' using 1:2 with steps lw 2 lc rgb 'black' title 'truth "
        "objects that count', \\\n"
        " '' using 1:3 with steps lw 2 lc rgb '{}' title 'of these not tracked', \\\n"
        " '' using 1:4 with steps lw 2 lc rgb '{}' title 'false objects'\nunset multiplot\nunset "
        "output\nreset session\n",
        kOrange, kBlue);
    script_ += kPreamble;
  }

  void reliabilityPlot() {
    const Reliability r = reliability(run_.evaluation, Pairing::kOneToOne);
    if (!r.calibration_error) return;
    std::string rows = "# mean stated probability, share correct, instants\n";
    for (const ReliabilityBin& bin : r.bins) {
      if (bin.count)
        rows += fmt::format("{:.6f} {:.6f} {}\n", *bin.mean_probability, *bin.correct, bin.count);
    }
    data("reliability.dat", rows);
    begin("reliability.png", 760, 760);
    script_ += fmt::format(
        "set title {} noenhanced font ',13'\n",
        gnuplotString(fmt::format(
            "Can the class probability be believed? {}\nmean |stated - correct| = {:.3f}",
            run_.name, *r.calibration_error)));
    script_ += fmt::format(
        "set size square\nset key top left\nset xrange [0:1.05]\nset yrange [0:1.05]\nset xlabel "
        "'stated probability of the most probable class'\n"
        "set ylabel 'share of instants at which that class is right'\n"
        "plot x with lines dt 2 lw 2 lc rgb 'black' title 'stated = right', \\\n"
        " 'reliability.dat' using 1:2 with linespoints pt 7 ps 1.5 lw 2 lc rgb '{}' title 'this "
        "run (number of instants)', \\\n"
        " '' using 1:2:(sprintf('%d', $3)) with labels offset -1,-1.2 notitle\nunset output\n",
        kBlue);
  }

  void object(const ObjectTimeline& o) {
    const std::string name = fmt::format("object_{}", o.id);
    std::map<std::uint64_t, std::string> estimates;
    std::string truth = "# t [s], range to the closest point [m], bearing [deg]\n";
    std::size_t last_instant = 0;
    for (const TruthSample& s : run_.evaluation.samples) {
      if (s.id != o.id) continue;
      // A blank line lifts the pen where the object does not count.
      if (s.instant > last_instant + 1) truth += "\n";
      last_instant = s.instant;
      truth += polar(s.t, s.view);
      if (const auto& m = s.matched(Pairing::kOneToOne)) estimates[m->id] += polar(s.t, m->view);
    }
    std::string blocks = truth;
    for (const std::uint64_t id : o.ids) {
      blocks += fmt::format("\n\n# estimate with id {}\n{}", id, estimates[id]);
    }
    data(name + ".dat", blocks);
    begin(name + ".png", 1000, 700);
    script_ +=
        fmt::format("set multiplot layout 2,1 title {} noenhanced font ',14'\n",
                    gnuplotString(fmt::format("{}, {}: tracked at {} of {} instants", objectName(o),
                                              run_.name, o.returns, o.active)));
    script_ += "set lmargin 10\nset rmargin 3\nset key outside top right horizontal\n";
    script_ +=
        fmt::format("set xrange [{:.3f}:{:.3f}]\n", o.first_active - 0.2, o.last_active + 0.2);
    script_ += "unset xlabel\nset ylabel 'range to closest point (m)'\nset yrange [0:*]\n" +
               curves(name, 2, o);
    script_ +=
        "set xlabel 'time since the log''s first stamp (s)'\nset ylabel 'bearing of centre (deg, "
        "left +)'\nset yrange [*:*]\n" +
        curves(name, 3, o) + "unset multiplot\nset xrange [*:*]\nunset output\n";
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
    script_ += fmt::format(
        "set terminal pngcairo size {},{} font 'sans,10' background rgb 'white'\nset output '{}'\n",
        width, height, file);
  }

  static std::string polar(double t, const GroundView& view) {
    return fmt::format("{:.3f} {:.4f} {:.4f}\n", t, view.closest_range, degrees(view.bearing));
  }

  std::string curves(const std::string& name, int column, const ObjectTimeline& o) const {
    std::string plot =
        fmt::format("plot '{}.dat' index 0 using 1:{} with lines lw 3 lc rgb 'black' title 'truth'",
                    name, column);
    for (std::size_t i = 0; i < o.ids.size(); ++i) {
      plot += fmt::format(", \\\n '' index {} using 1:{} with points pt 7 ps 0.8 lc rgb '{}' ",
                          i + 1, column, i < kMaxNamedIds ? kIdColours[i] : kGrey);
      if (i < kMaxNamedIds) {
        plot += fmt::format("title 'estimate, id {}'", o.ids[i]);
      } else {
        plot += i == kMaxNamedIds ? "title 'further ids'" : "notitle";
      }
    }
    return plot + "\n";
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

  std::string timeRange() const {
    const auto& instants = run_.evaluation.instants;
    return fmt::format("set xrange [{:.3f}:{:.3f}]\n", instants.front().t - 0.2,
                       instants.back().t + 0.2);
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
