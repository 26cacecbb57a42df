#include "studies/resolution/ResolutionPlots.h"

#include <fmt/format.h>

#include "libperception/evaluation/plots/Gnuplot.h"
#include "libperception/evaluation/plots/PlotScript.h"
#include "libperception/evaluation/tables/PaperTables.h"

namespace perception {
namespace {

constexpr std::size_t kFewest = 10;  // objects of a point in the plot
const char* const kLabels[] = {"car", "person"};

}  // namespace

double rangeOf(const CameraResolution& row, int kind) {
  return kind == 0 ? row.car_range : row.person_range;
}

const CameraResolution& rowOf(const ResolutionRun& run) {
  return cameraResolutions()[static_cast<std::size_t>(run.resolution)];
}

StudyPlot recallPlot(const std::vector<CameraFigures>& cameras, const std::string& where) {
  StudyPlot plot;
  plot.name = "recall";
  plot.caption =
      "Recall of unoccluded objects over the distance as a share of Radecki et al.'s range for "
      "that resolution; gray: Radecki et al. within range. Where the curves fall together recall "
      "is independent of resolution.";
  plot.width = 1100, plot.height = 460;
  plot.script = fmt::format(
      "set multiplot layout 1,2 title {} noenhanced\nset grid\nset yrange [0:1.02]\nset xrange "
      "[0:1.6]\n"
      "set xlabel 'distance / range of the resolution'\n",
      gnuplotString(where));
  for (int k = 0; k < 2; ++k) {
    const auto paper =
        k == 0 ? paperFrontEndRows()[1].car_recall : paperFrontEndRows()[1].person_recall;
    plot.script += fmt::format(
        "set ylabel '{} recall'\nset key {}\nplot (x<=1 ? {} : 1/0) lw 6 lc rgb '{}' title "
        "'Radecki et al.'",
        k == 0 ? "car" : "person", "bottom left", paper.value_or(0), plot_color::kGray);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      const CameraFigures& c = cameras[i];
      if (!c.rates) continue;
      const std::string file = fmt::format("recall_{}_{}.dat", kLabels[k], rowOf(*c.run).name);
      std::string data;
      double middle = 0.5;
      for (const RecallCounts& r : c.rates->recall[static_cast<std::size_t>(k)]) {
        if (r.in_view >= kFewest)
          data += fmt::format("{:.3f} {:.4f}\n", middle / RangeRates::kBins,
                              *shareOf(r.named, r.in_view));
        ++middle;
      }
      if (data.empty()) continue;
      plot.data.push_back({file, data});
      plot.script +=
          fmt::format(", '{}' with linespoints lw 2 lc rgb '{}' title '{}: {:g} m'", file,
                      plot_color::ofRun(i), rowOf(*c.run).name, rangeOf(rowOf(*c.run), k));
    }
    plot.script += '\n';
  }
  plot.script += "unset multiplot\n";
  return plot;
}

StudyPlot ratePlot(const StudyTable& table, const std::string& what, const std::string& where) {
  StudyPlot plot;
  plot.name = table.name;
  plot.caption = table.title + "; full: here, hatched: Radecki et al.";
  plot.width = 1000, plot.height = 460;
  std::string data;
  for (const auto& row : table.rows) {
    data += '"' + row[0] + '"';
    for (std::size_t i = 1; i <= 6; ++i) data += ' ' + (row[i].empty() ? "?" : row[i]);
    data += '\n';
  }
  plot.data.push_back({table.name + ".dat", data});
  plot.script = fmt::format(
      "set title {} noenhanced\nset style data histograms\nset style histogram clustered gap 1.5\n"
      "set datafile missing '?'\nset logscale y\nset yrange [0.02:200]\nset grid y\n"
      "set ylabel '{}'\nset key outside right\nset boxwidth 0.95\nplot ",
      gnuplotString(where), what);
  const char* names[] = {"objects", "cars", "persons"};
  for (int i = 0; i < 3; ++i) {
    const std::string color = plot_color::ofRun(static_cast<std::size_t>(i));
    plot.script += fmt::format(
        "{0}'{1}.dat' using {2}:xtic(1) fs solid 0.9 border lc rgb '{4}' lc rgb '{4}' title '{5}', "
        "'' using {3} fs pattern 4 border lc rgb '{4}' lc rgb '{4}' title 'Radecki et al.: {5}'",
        i ? ", " : "", table.name, i + 2, i + 5, color, names[i]);
  }
  plot.script += '\n';
  return plot;
}

}  // namespace perception
