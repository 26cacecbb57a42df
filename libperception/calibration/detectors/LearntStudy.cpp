#include "libperception/calibration/detectors/LearntStudy.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <iterator>

#include "libperception/calibration/detectors/ReliabilityCounts.h"
#include "libperception/core/Error.h"
#include "libperception/scene/ClassColors.h"

namespace perception {
namespace {

constexpr std::int64_t kSettled = 200;  // [frames]
// Windows of the convergence, doubling: more boxes where less changes.
constexpr std::int64_t kEdges[] = {0, 25, 50, 100, 200, 400, INT64_MAX};
constexpr std::size_t kWindows = std::size(kEdges) - 1;

/// Of the boxes of frames from `first` until before `end`.
ReliabilityCounts calibrationOf(const LearntGroup& group, std::int64_t first, std::int64_t end) {
  ReliabilityCounts c;
  for (const BoxLog& log : group.logs)
    for (const BoxWithTruth& b : log.boxes)
      if (b.scan >= first && b.scan < end && std::isfinite(b.stated))
        c.add(1 / (1 + std::exp(-b.stated)), b.sample.object);
  return c;
}

constexpr std::int64_t kEnd = INT64_MAX;

std::string number(double x) { return fmt::format("{:.3f}", x); }

/// A curve a group from NAME.dat, whose blocks are the groups.
std::string curves(const std::vector<LearntGroup>& groups, const std::string& name) {
  std::string script;
  for (std::size_t g = 0; g < groups.size(); ++g)
    script += fmt::format(
        ", '{}.dat' index {} using 1:2 with linespoints pt 7 lw 2 lc rgb '{}' "
        "title '{}'",
        name, g, hexOf(colorOfCurve(g)), groups[g].name);
  return script + "\n";
}

StudyPlot reliabilityPlot(const std::vector<LearntGroup>& groups) {
  StudyPlot plot;
  plot.name = "reliability";
  plot.caption = fmt::format(
      "Boxes from frame {} of their logs on: share of objects over the stated probability",
      kSettled);
  std::string data;
  for (const LearntGroup& group : groups) {
    for (const auto& row : calibrationOf(group, kSettled, kEnd).curve())
      data += fmt::format("{} {}\n", row[1], row[2]);
    data += "\n\n";
  }
  plot.data.emplace_back("reliability.dat", data);
  plot.script =
      "set xlabel 'stated probability that a box is an object'; set ylabel 'share of objects'\n"
      "set size square; set xrange [0:1]; set yrange [0:1]; set grid; set key noenhanced outside\n"
      "plot x with lines dt 2 lc rgb 'gray' notitle" +
      curves(groups, "reliability");
  return plot;
}

StudyPlot convergencePlot(const std::vector<LearntGroup>& groups) {
  StudyPlot plot;
  plot.name = "convergence";
  plot.caption = "Calibration error of the frames from each number on, until the next one";
  std::string data;
  for (const LearntGroup& group : groups) {
    for (std::size_t w = 0; w < kWindows; ++w) {
      const ReliabilityCounts c = calibrationOf(group, kEdges[w], kEdges[w + 1]);
      if (c.count() > 0) data += fmt::format("{} {}\n", w, c.error());
    }
    data += "\n\n";
  }
  plot.data.emplace_back("convergence.dat", data);
  std::string ticks;
  for (std::size_t w = 0; w < kWindows; ++w)
    ticks += fmt::format("{}'{}' {}", w ? ", " : "", kEdges[w], w);
  plot.script =
      "set xlabel 'from this frame since the begin on, until the next number'\n"
      "set ylabel 'expected calibration error'\n"
      "set xrange [-.5:5.5]; set xtics (" +
      ticks +
      "); set yrange [0:*]; set grid\n"
      "set key noenhanced outside\nplot NaN notitle" +
      curves(groups, "convergence");
  return plot;
}

}  // namespace

StudyReport learntStudy(const std::vector<LearntGroup>& groups) {
  StudyTable settled{
      "calibration",
      "Stated probability that a box is an object, against the truth",
      {"detector", "logs", "boxes", "error", fmt::format("boxes from frame {}", kSettled), "stated",
       "objects", "error", "by chance"},
      {}};
  StudyTable reliability{"reliability",
                         fmt::format("Reliability from frame {} on", kSettled),
                         {"detector", "boxes", "stated", "objects"},
                         {}};
  StudyTable convergence{"convergence",
                         "Calibration error by frame since the log's begin",
                         {"detector", "from frame", "boxes", "error", "by chance"},
                         {}};
  StudyReport report;
  bool simulated = false;
  std::string names;
  double boxes = 0;
  for (const LearntGroup& group : groups) {
    for (const BoxLog& log : group.logs) {
      simulated = simulated || log.simulated;
      names += (names.empty() ? "" : ", ") + group.name + "/" + log.name;
    }
    const ReliabilityCounts all = calibrationOf(group, 0, kEnd);
    boxes += all.count();
    if (all.count() == 0) continue;
    const ReliabilityCounts late = calibrationOf(group, kSettled, kEnd);
    settled.rows.push_back({group.name, fmt::format("{}", group.logs.size()),
                            fmt::format("{:.0f}", all.count()), number(all.error()),
                            fmt::format("{:.0f}", late.count())});
    for (const double x : {late.stated(), late.objects(), late.error(), late.chance()})
      settled.rows.back().push_back(late.count() > 0 ? number(x) : "n/a");
    for (const auto& row : late.curve())
      reliability.rows.push_back(
          {group.name, fmt::format("{:.0f}", row[0]), number(row[1]), number(row[2])});
    for (std::size_t w = 0; w < kWindows; ++w) {
      const ReliabilityCounts c = calibrationOf(group, kEdges[w], kEdges[w + 1]);
      if (c.count() > 0)
        convergence.rows.push_back({group.name, fmt::format("{}", kEdges[w]),
                                    fmt::format("{:.0f}", c.count()), number(c.error()),
                                    number(c.chance())});
    }
  }
  if (boxes == 0) throw DataError("no box in space of any log can be judged by its truth");
  report.title = "How true learned confidence is";
  report.data = fmt::format("{}logs {}", simulated ? "simulated " : "", names);
  report.tables = {std::move(settled), std::move(reliability), std::move(convergence)};
  report.plots = {reliabilityPlot(groups), convergencePlot(groups)};
  report.remarks = {
      "Every log is learned from nothing; its frames are rated by what the earlier ones taught.",
      "Error: mean distance of stated probability and share of objects in tenths, weighted by "
      "boxes. "
      "By chance: what is expected of as many independent boxes with true probabilities.",
      "Boxes on objects of another class, within 2 m of an object that they miss, and in areas "
      "that "
      "the truth does not label are left out."};
  return report;
}

}  // namespace perception
