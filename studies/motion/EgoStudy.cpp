#include "studies/motion/EgoStudy.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libperception/core/Error.h"
#include "libperception/core/math/Chi2.h"
#include "libperception/evaluation/plots/Gnuplot.h"
#include "libperception/sensors/ego/CEgoFilter.h"
#include "libperception/sensors/ego/EgoFusion.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/simulation/Simulator.h"

namespace perception {
namespace {

constexpr double kEvery = 0.5;         // [s] sampling interval
constexpr double kConfidence = 0.999;  // of the interval of the mean NEES
constexpr int kAxes = 3;

/// The scenario with ego-motion sensors only, so that no rays are cast.
Scenario withoutLooking(Scenario scenario) {
  auto& sensors = scenario.sensors;
  sensors.erase(std::remove_if(sensors.begin(), sensors.end(),
                               [](const SensorParams& s) { return !s.isOfEgo(); }),
                sensors.end());
  scenario.objects.clear();
  scenario.params.rate = 0.1;
  scenario.ego.pose.rate = 0;
  return scenario;
}

const SensorParams* receiverOf(const Scenario& scenario) {
  for (const SensorParams& s : scenario.sensors) {
    if (s.kind == SensorKind::kGnss) return &s;
  }
  return nullptr;
}

/// Time interval with its own row of metrics.
struct Phase {
  std::string name;
  double from, to;  ///< [s]
};

std::vector<Phase> phasesOf(const EgoStudyParams& params) {
  const auto& gnss = receiverOf(params.scenario)->gnss;
  std::vector<Phase> phases;
  double from = params.warm_up;
  for (std::size_t i = 0; i < gnss.gap_from.size(); ++i) {
    phases.push_back({"satellites", from, gnss.gap_from[i]});
    phases.push_back({fmt::format("gap of {:.0f} s", gnss.gap_to[i] - gnss.gap_from[i]),
                      gnss.gap_from[i], gnss.gap_to[i]});
    from = gnss.gap_to[i];
  }
  phases.push_back({"satellites", from, params.scenario.params.duration + 1});
  return phases;
}

using Runs = std::vector<std::vector<EgoError>>;

StudyTable phaseTable(const EgoStudyParams& params, const Runs& runs) {
  StudyTable table;
  table.name = "phases";
  table.title = fmt::format("Errors against the truth, {} runs (simulated)", runs.size());
  table.columns = {"from [s]",           "to [s]",       "",
                   "position rms [m]",   "worst [m]",    "sigma [m]",
                   "yaw rms [deg]",      "worst [deg]",  "sigma [deg]",
                   "beyond 3 sigma [%]", "mean NEES (3)"};
  for (const Phase& phase : phasesOf(params)) {
    double position = 0, yaw = 0, worst = 0, worst_yaw = 0, sigma = 0, sigma_yaw = 0, nees = 0;
    int count = 0, outside = 0;
    for (const auto& run : runs) {
      for (const EgoError& e : run) {
        if (e.t <= phase.from || e.t > phase.to) continue;
        ++count;
        const double d2 = e.error.head<2>().squaredNorm();
        position += d2, yaw += e.error[2] * e.error[2], nees += e.nees();
        worst = std::max(worst, std::sqrt(d2));
        worst_yaw = std::max(worst_yaw, std::abs(e.error[2]));
        sigma += (e.P(0, 0) + e.P(1, 1)), sigma_yaw += e.P(2, 2);
        for (int i = 0; i < kAxes; ++i) outside += std::abs(e.error[i]) > 3 * std::sqrt(e.P(i, i));
      }
    }
    if (count == 0) continue;
    const auto root = [count](double sum) { return std::sqrt(sum / count); };
    table.rows.push_back(
        {fmt::format("{:.0f}", phase.from), fmt::format("{:.0f}", phase.to), phase.name,
         fmt::format("{:.2f}", root(position)), fmt::format("{:.2f}", worst),
         fmt::format("{:.2f}", root(sigma)), fmt::format("{:.2f}", degrees(root(yaw))),
         fmt::format("{:.2f}", degrees(worst_yaw)), fmt::format("{:.2f}", degrees(root(sigma_yaw))),
         fmt::format("{:.2f}", 100.0 * outside / (kAxes * count)),
         fmt::format("{:.2f}", nees / count)});
  }
  return table;
}

/// Mean NEES of all runs by instant; only instants of all runs.
std::vector<std::pair<double, double>> meanNees(const Runs& runs) {
  std::vector<std::pair<double, double>> mean;
  for (const EgoError& first : runs.front()) {
    double sum = 0;
    std::size_t count = 0;
    for (const auto& run : runs) {
      for (const EgoError& e : run) {
        if (std::abs(e.t - first.t) > kEvery / 4) continue;
        sum += e.nees();
        ++count;
        break;
      }
    }
    if (count == runs.size()) mean.emplace_back(first.t, sum / static_cast<double>(count));
  }
  return mean;
}

std::array<double, 2> interval(std::size_t runs) {
  const int freedom = kAxes * static_cast<int>(runs);
  return {chi2Quantile((1 - kConfidence) / 2, freedom) / static_cast<double>(runs),
          chi2Quantile((1 + kConfidence) / 2, freedom) / static_cast<double>(runs)};
}

StudyPlot plotOf(const EgoStudyParams& params, const Runs& runs) {
  StudyPlot plot;
  plot.name = "ego";
  plot.width = 1000, plot.height = 1100;
  plot.caption =
      "Error of the vehicle's pose with the filter's 3 sigma (band: first run), all runs, and the "
      "mean NEES with its 99.9 % interval (simulated). Gray: no satellites.";
  std::string first, others, nees;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    for (const EgoError& e : runs[r]) {
      const std::string line =
          fmt::format("{:.2f} {:.4f} {:.4f} {:.4f} {:.4f} {:.4f} {:.4f}\n", e.t, e.error[0],
                      e.error[1], degrees(e.error[2]), 3 * std::sqrt(e.P(0, 0)),
                      3 * std::sqrt(e.P(1, 1)), degrees(3 * std::sqrt(e.P(2, 2))));
      (r == 0 ? first : others) += line;
    }
    if (r > 0) others += '\n';
  }
  for (const auto& [t, value] : meanNees(runs)) nees += fmt::format("{:.2f} {:.4f}\n", t, value);
  plot.data = {{"ego_first.dat", first}, {"ego_others.dat", others}, {"ego_nees.dat", nees}};
  const double end = params.scenario.params.duration;
  plot.script =
      fmt::format("set multiplot layout 4,1 title {} noenhanced\nset grid\nset xrange [0:{}]\n",
                  gnuplotString(params.name + " (simulated)"), end);
  const auto& gnss = receiverOf(params.scenario)->gnss;
  for (std::size_t i = 0; i < gnss.gap_from.size(); ++i) {
    plot.script += fmt::format(
        "set object {} rectangle from {}, graph 0 to {}, graph 1 behind fillcolor '#dddddd' "
        "fillstyle solid noborder\n",
        i + 1, gnss.gap_from[i], gnss.gap_to[i]);
  }
  plot.script += "set lmargin 9\nset key top left horizontal\n";
  const std::array<const char*, 3> labels = {"error in x [m]", "error in y [m]",
                                             "error in yaw [deg]"};
  for (int i = 0; i < kAxes; ++i) {
    plot.script += fmt::format(
        "set ylabel '{}'\nplot 'ego_first.dat' using 1:(-${}):{} with filledcurves "
        "fillcolor '#c6dbef' title '3 sigma', 'ego_others.dat' using 1:{} with lines lw 0.5 "
        "linecolor '#999999' title 'other runs', 'ego_first.dat' using 1:{} with lines lw 2 "
        "linecolor '#08519c' title 'first run'\n",
        labels[static_cast<std::size_t>(i)], i + 5, i + 5, i + 2, i + 2);
    if (i == 0) plot.script += "unset key\n";
  }
  const auto bounds = interval(runs.size());
  plot.script += fmt::format(
      "set key top left horizontal\nset ylabel 'mean NEES'\nset xlabel 'time [s]'\nset yrange "
      "[0:*]\nplot 'ego_nees.dat' with "
      "lines lw 2 linecolor '#08519c' title 'mean over {} runs', {} with lines dashtype 2 "
      "linecolor black title '99.9 %', {} with lines dashtype 2 linecolor black notitle\nunset "
      "multiplot\n",
      runs.size(), bounds[0], bounds[1]);
  return plot;
}

}  // namespace

std::vector<EgoError> runEgo(const EgoStudyParams& params, std::uint64_t seed) {
  const SensorParams* receiver = receiverOf(params.scenario);
  EgoPoseParams ego_params = params.ego;
  ego_params.source = EgoPoseParams::Source::kFusion;
  // Filter and scene share the world frame, so that poses can be compared.
  ego_params.fusion.origin = {receiver->gnss.latitude, receiver->gnss.longitude,
                              receiver->gnss.height};
  EgoPose ego(ego_params);
  Simulator simulator(withoutLooking(params.scenario), params.name, seed);
  std::vector<EgoError> errors;
  std::optional<Stamp> start;
  double next = 0;
  while (const auto observation = simulator.next()) {
    const Stamp stamp = *toStamp(observation->timestamp);
    if (!start) start = stamp;
    // Evaluate before an observation of a later stamp is added; a delayed fix has an earlier stamp.
    while (stamp - *start > next + 1e-6) {
      const EgoMotionState& state = ego.fusion().state();
      if (state.heading_known) {
        EgoError e;
        e.t = state.stamp - *start;
        const EgoState real = simulator.world().ego(e.t);
        const EgoVector& x = state.estimate.x;
        e.error << x[kEgoX] - real.T_world_ego.translation().x(),
            x[kEgoY] - real.T_world_ego.translation().y(),
            wrapAngle(x[kEgoYaw] - yawOf(real.T_world_ego));
        const std::array<int, kAxes> axes = {kEgoX, kEgoY, kEgoYaw};
        for (int i = 0; i < kAxes; ++i) {
          for (int j = 0; j < kAxes; ++j)
            e.P(i, j) = state.estimate.P(axes[static_cast<std::size_t>(i)],
                                         axes[static_cast<std::size_t>(j)]);
        }
        errors.push_back(e);
      }
      next += kEvery;
    }
    ego.add(*observation);
  }
  return errors;
}

StudyReport egoStudy(const EgoStudyParams& params) {
  if (receiverOf(params.scenario) == nullptr)
    throw ConfigError(params.name + ": a scenario with a [sensor.LABEL] of kind gnss is needed");
  Runs runs;
  for (int k = 0; k < params.runs; ++k)
    runs.push_back(runEgo(params, params.seed + static_cast<std::uint64_t>(k)));
  StudyReport report;
  report.title = "The vehicle's own pose from satellites, inertial unit and wheels";
  report.data = "simulated: scenario " + params.name;
  report.tables.push_back(phaseTable(params, runs));
  report.plots.push_back(plotOf(params, runs));
  const auto bounds = interval(runs.size());
  int beyond = 0, count = 0;
  for (const auto& [t, value] : meanNees(runs)) {
    if (t < params.warm_up) continue;
    ++count;
    beyond += value < bounds[0] || value > bounds[1];
  }
  report.remarks.push_back(fmt::format(
      "The mean NEES of {} runs lies outside of its 99.9 % chi-square interval [{:.2f}, {:.2f}] "
      "at {} of {} instants from {:.0f} s on.",
      runs.size(), bounds[0], bounds[1], beyond, count, params.warm_up));
  return report;
}

}  // namespace perception
