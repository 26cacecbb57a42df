#include "studies/paper/PersonFilterStudy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/evaluation/plots/Gnuplot.h"
#include "libperception/lidar/LidarFrontEnd.h"
#include "libperception/lidar/ground/GroundPlane.h"
#include "libperception/lidar/two_spacings/PersonResponse.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/rawlog/RawlogReader.h"

namespace perception {
namespace {

constexpr double kWindow = 8;   // [m] half a side of the surface's picture
constexpr double kWithin = 25;  // [m] of the sensor, for the search of the highest peak

/// Obstacle returns of one scan.
struct Returns {
  std::vector<float> x, y, height;  ///< [m] ego frame, above ground
  std::string source;
  void add(double px, double py, double h) {
    x.push_back(static_cast<float>(px)), y.push_back(static_cast<float>(py));
    height.push_back(static_cast<float>(h));
  }
};

/// A person 12 m ahead, a car, a wall and a pole around, their near sides sampled at 0.2 deg in
/// azimuth and 0.4 deg in elevation.
Returns simulatedReturns() {
  constexpr double kAcross = radians(0.2), kUp = radians(0.4);
  Returns returns;
  returns.source = "simulated returns";
  const auto rows = [&](double px, double py, double top) {
    const double step = std::hypot(px, py) * kUp;
    for (double h = 0.35; h <= top; h += step) returns.add(px, py, h);
  };
  const auto round = [&](double px, double py, double radius, double top) {
    const double range = std::hypot(px, py), bearing = std::atan2(py, px);
    for (double b = -std::asin(radius / range); b <= std::asin(radius / range); b += kAcross) {
      const double off = range * std::sin(b);
      const double depth = range - std::sqrt(std::max(0.0, radius * radius - off * off));
      rows(depth * std::cos(bearing + b), depth * std::sin(bearing + b), top);
    }
  };
  const auto side = [&](Vector2 from, Vector2 to, double top) {
    const double length = (to - from).norm(), step = from.norm() * kAcross;
    for (double s = 0; s <= length; s += step) {
      const Vector2 p = from + (to - from) * (s / length);
      rows(p.x(), p.y(), top);
    }
  };
  round(12, 0, 0.25, 1.75);
  round(14, 4, 0.06, 2.4);
  side({9, -6}, {13.4, -6}, 1.45), side({9, -6}, {9, -7.8}, 1.45);
  side({17, -8}, {17, 2}, 2.6);
  return returns;
}

Returns returnsOfLog(const std::string& log) {
  RawlogReader reader(log);
  while (const auto observation = reader.next()) {
    auto frame = frameFromObservation(*observation);
    if (!frame || !std::holds_alternative<LidarCloud>(frame->data)) continue;
    GroundEstimator ground;
    frame->ground = ground.update(*frame);
    const LidarParams params;
    ClassTable classes;
    classes.classes.resize(1);
    const LidarFrontEnd lidar(params, classes,
                              DetectionModel(DetectionParams{}, {ClassDetection{}},
                                             LidarFrontEnd::labels(params.clusters)));
    LidarDetections found = lidar.detect(*frame);
    return {std::move(found.x), std::move(found.y), std::move(found.above),
            "the first lidar scan of " + log};
  }
  throw DataError(log + ": no lidar scan");
}

StudyPlot kernelPlot() {
  PersonParams consistent, printed;
  printed.kernel = PersonParams::Kernel::kPrinted;
  std::string data;
  for (int k = 0; k <= 225; ++k) {
    const double r = 0.01 * k;
    data += fmt::format("{:.2f} {:.5f} {:.5f}\n", r, personKernel(r, consistent),
                        personKernel(r, printed));
  }
  StudyPlot plot;
  plot.name = "kernel";
  plot.caption =
      "The kernel over the radius. The text wants a negative mean: only the reading with sigma^4 "
      "has one (-0.90 against +0.06, integrated over the plane).";
  plot.data = {{"kernel.dat", data}};
  plot.script =
      "set grid\nset xlabel 'distance from the middle [m]'\nset ylabel 'response per return "
      "[1/m^2]'\nset xzeroaxis lw 1\nset key top right\nplot 'kernel.dat' using 1:2 with lines lw "
      "3 linecolor '#08519c' title 'second term with sigma^4 (used)', 'kernel.dat' using 1:3 with "
      "lines lw 2 dashtype 2 linecolor '#b30000' title 'with sigma^2, as printed'\n";
  return plot;
}

/// Surface plot of the response around `middle`.
StudyPlot surfacePlot(const Returns& returns, const PersonResponse& response,
                      const Vector2& middle) {
  std::string data, places;
  double last_y = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t k = 0; k < response.values().size(); ++k) {
    const Vector2 at = response.center(k);
    if ((at - middle).cwiseAbs().maxCoeff() > kWindow) continue;
    if (at.y() != last_y && !data.empty()) data += '\n';
    last_y = at.y();
    data += fmt::format("{:.3f} {:.3f} {:.3f}\n", at.x(), at.y(),
                        static_cast<double>(response.values()[k]));
  }
  for (std::size_t i = 0; i < returns.x.size(); ++i) {
    const Vector2 at(static_cast<double>(returns.x[i]), static_cast<double>(returns.y[i]));
    if ((at - middle).cwiseAbs().maxCoeff() <= kWindow)
      places += fmt::format("{:.3f} {:.3f}\n", at.x(), at.y());
  }
  StudyPlot plot;
  plot.name = "response";
  plot.width = 1400, plot.height = 620;
  plot.caption =
      "The filter's response to " + returns.source +
      ", obliquely and from above (dots: the returns). A person is a peak with a moat around it; "
      "walls and sides of cars answer with less per return, fields with less than nothing.";
  plot.data = {{"response.dat", data}, {"returns.dat", places}};
  plot.script = fmt::format(
      "set multiplot layout 1,2 title {0} noenhanced\n"
      "set palette defined (-1 '#2166ac', 0 '#f7f7f7', 1 '#b2182b')\n"
      "stats 'response.dat' using 3 nooutput\nset cbrange [-STATS_max:STATS_max]\nunset colorbox\n"
      "set xrange [{1}:{2}]\nset yrange [{3}:{4}]\n"
      "set xlabel 'ahead [m]'\nset ylabel 'to the left [m]'\nset zlabel 'response' rotate\n"
      "set view 50,330,1.15\nset xyplane relative 0.05\nset hidden3d\n"
      "set pm3d depthorder border linecolor '#555555' lw 0.2\n"
      "splot 'response.dat' using 1:2:3 with pm3d notitle\n"
      "unset hidden3d\nset colorbox\nset cblabel 'response'\nset size ratio -1\n"
      "plot 'response.dat' using 1:2:3 with image notitle, 'returns.dat' using 1:2 with points "
      "pointtype 7 pointsize 0.2 linecolor '#333333' notitle\nunset multiplot\n",
      gnuplotString(returns.source), middle.x() - kWindow, middle.x() + kWindow,
      middle.y() - kWindow, middle.y() + kWindow);
  return plot;
}

StudyTable peaksTable(const std::vector<PersonPeak>& peaks) {
  StudyTable table;
  table.name = "peaks";
  table.title = "Person-sized peaks, strongest first";
  table.columns = {"ahead [m]",  "left [m]", "returns",  "response",
                   "per return", "top [m]",  "width [m]"};
  for (const PersonPeak& p : peaks)
    table.rows.push_back({fmt::format("{:.2f}", p.center.x()), fmt::format("{:.2f}", p.center.y()),
                          fmt::format("{}", p.points.size()), fmt::format("{:.1f}", p.response),
                          fmt::format("{:.2f}", p.normalized),
                          fmt::format("{:.2f}", static_cast<double>(p.highest)),
                          fmt::format("{:.2f}", p.width)});
  return table;
}

}  // namespace

StudyReport personFilterStudy(const std::string& log) {
  const Returns returns = log.empty() ? simulatedReturns() : returnsOfLog(log);
  const PersonParams params;
  const auto peaks = findPersons(returns.x, returns.y, returns.height, params);
  Vector2 middle(12, 0);
  double clearest = 0;
  for (const PersonPeak& peak : peaks)
    if (peak.center.norm() <= kWithin && peak.normalized > clearest)
      clearest = peak.normalized, middle = peak.center;

  StudyReport report;
  report.title = "Person filter: kernel and response";
  report.data = returns.source;
  report.tables.push_back(peaksTable(peaks));
  report.plots.push_back(kernelPlot());
  if (!returns.x.empty())
    report.plots.push_back(
        surfacePlot(returns, PersonResponse(returns.x, returns.y, {}, params), middle));
  report.remarks.push_back(
      "A peak counts by its response per return: a person has about 1.45, a wall less than 0.5, at "
      "any range.");
  return report;
}

}  // namespace perception
