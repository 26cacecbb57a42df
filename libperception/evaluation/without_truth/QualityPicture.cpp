#include "libperception/evaluation/without_truth/QualityPicture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "libperception/evaluation/plots/Gnuplot.h"
#include "libperception/evaluation/without_truth/QualityParts.h"

namespace perception {
namespace {

constexpr std::size_t kMostNumbers = 40;  ///< of objects beside moments: more hide each other

struct KindStyle {
  const char* title;
  const char* color;
  int point;  ///< gnuplot's point type
};
/// In the order of QualityMoment::Kind; colors that a color-blind reader tells apart.
constexpr KindStyle kStyles[kMomentKinds] = {{"class changes", "#E69F00", 9},
                                             {"less than a second", "#56B4E9", 7},
                                             {"vanishes in view", "#D55E00", 13},
                                             {"continues another", "#000000", 5}};

constexpr const char* kScript = R"(set multiplot layout 1,2
set title 'from above: the vehicle green, objects of named classes gray, others pale'
set size ratio -1
set xlabel 'x (m)'
set ylabel 'y (m)'
set key top left
plot 'others.txt' using 1:2 with lines lc rgb '#DDDDDD' notitle, \
  'ways.txt' using 1:2 with lines lw 2 lc rgb '#777777' notitle, \
  'ego.txt' using 1:2 with lines lw 3 lc rgb '#009E73' notitle{above}
set size noratio
set title 'objects of named classes, and moments, over time'
set xlabel 'time (s)'
set ylabel 'objects'
set yrange [0:*]
plot 'counts.txt' using 1:2 with steps lc rgb '#888888' title 'objects'{over}
unset multiplot
)";

}  // namespace

StudyPlot momentsPicture(const TrackedRun& run, const Quality& quality,
                         const QualityOptions& options) {
  const QualitySector sector(run, options);
  const auto isNamed = [&](const SceneObject& o) { return sector.named(o); };
  StudyPlot plot;
  plot.name = "moments", plot.caption = "Moments to look at, from above and over time";
  plot.width = 1600, plot.height = 800;
  Vector2 origin = Vector2::Zero();
  if (!run.scenes.empty()) origin = run.scenes.front().ego.T_world_ego.translation().head<2>();
  std::map<std::uint64_t, std::string> way_of, other_way_of;
  std::map<std::int64_t, std::size_t> count_at;  // objects by milliseconds
  std::string ego, counts;
  for (const Scene& scene : run.scenes) {
    const double t = scene.stamp - run.first_stamp;
    const Vector2 at = scene.ego.T_world_ego.translation().head<2>() - origin;
    ego += fmt::format("{:.2f} {:.2f}\n", at.x(), at.y());
    const auto named = static_cast<std::size_t>(
        std::count_if(scene.objects.begin(), scene.objects.end(), isNamed));
    counts += fmt::format("{:.3f} {}\n", t, named);
    count_at[std::llround(1e3 * t)] = named;
    for (const SceneObject& o : scene.objects)
      (isNamed(o) ? way_of : other_way_of)[o.id] +=
          fmt::format("{:.2f} {:.2f}\n", o.position.x() - origin.x(), o.position.y() - origin.y());
  }
  std::string ways, others, above, over;
  for (const auto& [id, way] : way_of) ways += way + "\n";
  for (const auto& [id, way] : other_way_of) others += way + "\n";
  std::string moments[kMomentKinds], numbers;
  for (std::size_t i = 0; i < quality.moments.size(); ++i) {
    const QualityMoment& m = quality.moments[i];
    const Vector2 at = m.place - origin;
    const auto count = count_at.find(std::llround(1e3 * m.t));
    moments[static_cast<int>(m.kind)] +=
        fmt::format("{:.2f} {:.2f} {:.3f} {}\n", at.x(), at.y(), m.t,
                    count == count_at.end() ? 0 : count->second);
    if (i < kMostNumbers) numbers += fmt::format("{:.2f} {:.2f} {}\n", at.x(), at.y(), m.id);
  }
  for (int k = 0; k < kMomentKinds; ++k) {
    if (moments[k].empty()) continue;
    const std::string file = fmt::format("moments{}.txt", k);
    const std::string style = fmt::format("with points pt {} ps 1.3 lc rgb '{}' title '{}'",
                                          kStyles[k].point, kStyles[k].color, kStyles[k].title);
    above += fmt::format(", '{}' using 1:2 {}", file, style);
    over += fmt::format(", '{}' using 3:4 {}", file, style);
    plot.data.emplace_back(file, moments[k]);
  }
  if (!numbers.empty()) {
    above += ", 'numbers.txt' using 1:2:3 with labels offset 1,0.6 font ',9' notitle";
    plot.data.emplace_back("numbers.txt", numbers);
  }
  // Never empty: gnuplot would stop at a file without points.
  plot.data.emplace_back("ways.txt", ways.empty() ? "0 0\n" : ways);
  plot.data.emplace_back("others.txt", others.empty() ? "0 0\n" : others);
  plot.data.emplace_back("ego.txt", ego.empty() ? "0 0\n" : ego);
  plot.data.emplace_back("counts.txt", counts.empty() ? "0 0\n" : counts);
  plot.script = fmt::format(kScript, fmt::arg("above", above), fmt::arg("over", over));
  return plot;
}

StudyPlot followingPicture(const std::vector<FiguresAndErrors>& runs) {
  constexpr int kColumns = 3;
  StudyPlot plot;
  plot.name = "following",
  plot.caption = "Figures without a truth over the errors that they follow";
  std::string panels;
  int shown = 0;
  for (std::size_t k = 0; k < qualityKinds().size(); ++k) {
    const QualityKind& kind = qualityKinds()[k];
    if (!kind.follows_it()) continue;
    std::string points;
    for (const FiguresAndErrors& r : runs) {
      const Figure error = r.errors[static_cast<std::size_t>(kind.follows)];
      if (r.values[k] && error) points += fmt::format("{:.6g} {:.6g}\n", *error, *r.values[k]);
    }
    ++shown;
    const std::string title = gnuplotString(fmt::format("{} [{}]", kind.name, kind.unit));
    if (points.empty()) {
      panels += fmt::format(
          "set title {}\nset xrange [0:1]\nset yrange [0:1]\nplot NaN notitle\n"
          "set xrange [*:*]\nset yrange [0:*]\n",
          gnuplotString(std::string(kind.name) + ": in no run"));
      continue;
    }
    const std::string file = fmt::format("{}.txt", kind.name);
    plot.data.emplace_back(file, points);
    panels += fmt::format(
        "set title {} noenhanced\nset xlabel {} noenhanced\n"
        "plot '{}' using 1:2 with points pt 7 ps 0.8 lc rgb '#0072B2' notitle\n",
        title, gnuplotString(std::string("true: ") + nameOf(kind.follows)), file);
  }
  const int rows = (shown + kColumns - 1) / kColumns;
  plot.width = 1400, plot.height = 380 * rows;
  plot.script = fmt::format("set multiplot layout {},{}\nset yrange [0:*]\n{}unset multiplot\n",
                            rows, kColumns, panels);
  return plot;
}

}  // namespace perception
