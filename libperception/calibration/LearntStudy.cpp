#include "libperception/calibration/LearntStudy.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>

#include "libperception/calibration/ReliabilityCounts.h"
#include "libperception/core/Error.h"
#include "libperception/scene/ClassColors.h"

namespace perception {
namespace {

constexpr std::int64_t kSettled = 200;             // [frames]
constexpr std::int64_t kWindow = 50, kLast = 400;  // [frames] of the convergence; all later ones

/// Of the boxes of frames from `first` until before `end`.
ReliabilityCounts calibrationOf(const LearntGroup& group, std::int64_t first, std::int64_t end) {
  ReliabilityCounts c;
  for (const BoxLog& log : group.logs)
    for (const JudgedBox& b : log.boxes)
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
  plot.caption = fmt::format(
      "Calibration error of {} frames each since a log's begin, all logs; the last point: all "
      "later "
      "frames",
      kWindow);
  std::string data;
  for (const LearntGroup& group : groups) {
    for (std::int64_t first = 0; first <= kLast; first += kWindow) {
      const ReliabilityCounts c =
          calibrationOf(group, first, first < kLast ? first + kWindow : kEnd);
      if (c.count() > 0) data += fmt::format("{} {}\n", first + kWindow / 2, c.error());
    }
    data += "\n\n";
  }
  plot.data.emplace_back("convergence.dat", data);
  plot.script =
      "set xlabel 'frame since the begin'; set ylabel 'expected calibration error'\n"
      "set yrange [0:*]; set grid; set key noenhanced outside\n"
      "plot NaN notitle" +
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
    for (std::int64_t first = 0; first <= kLast; first += kWindow) {
      const ReliabilityCounts c =
          calibrationOf(group, first, first < kLast ? first + kWindow : kEnd);
      if (c.count() > 0)
        convergence.rows.push_back({group.name, fmt::format("{}", first),
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
