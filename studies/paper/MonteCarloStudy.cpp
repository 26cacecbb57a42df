#include "studies/paper/MonteCarloStudy.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/scene/ClassColors.h"

namespace perception {
namespace {

enum { kCyclist, kPedestrian };
constexpr std::uint32_t kMonteCarloPurpose = 0x5710;
const int kCounts[] = {5, 10, 15, 20, 30, 40, 50};
constexpr double kMedian = 1.986;  // [radecki2016]'s dashed line: median of chi-square(100) over 50

/// method.md 4.5: accelerations are variances (.31, .04), the rotation a deviation per step.
PaperClass classOf(int kind) {
  PaperClass c;
  c.wheeled = kind == kCyclist;
  c.accel_sigma = std::sqrt(kind == kCyclist ? 0.31 : 0.04);
  c.rotation_sigma = kind == kCyclist ? radians(15) : 0;
  return c;
}

struct PaperTrack {
  FilterTrace by_filter[2];

  double meanNis(int filter, std::size_t n) const {
    double sum = 0;
    for (std::size_t k = 0; k < n; ++k) sum += by_filter[filter].nis[k];
    return sum / static_cast<double>(n);
  }
  double logChi2(int filter, std::size_t n) const {
    const auto count = static_cast<double>(n);
    return logChi2Density(count * meanNis(filter, n), 2 * count);
  }
  /// From the third measurement on: the first two start the filters.
  double sequential(int filter, std::size_t n) const {
    double sum = 0;
    for (std::size_t k = 2; k < n; ++k) sum += by_filter[filter].log_density[k];
    return sum;
  }
};

PaperTrack makeTrack(const MonteCarloParams& p, int kind, std::uint64_t number) {
  Rng rng({p.seed, number, static_cast<std::uint32_t>(kind), kMonteCarloPurpose});
  Matrix2 R;
  R << 1.2, 0.1, 0.1, 1.2;  // [radecki2016]'s GPS receiver [m^2]
  if (p.noise_per_track) R = std::pow(rng.uniform(0.5, 1.7), 2) * Matrix2::Identity();
  const double speed = std::abs(rng.normal(kind == kCyclist ? 4.0 : 2.0, 0.5));  // method.md 4.5
  const auto z = simulatePaperTrack(classOf(kind), speed, p.steps, 1.0, R, rng);
  PaperTrack track;
  for (const int filter : {kCyclist, kPedestrian})
    track.by_filter[filter] = runPaperFilter(classOf(filter), z, 1.0, R);
  return track;
}

/// The members of MonteCarloFigures as numbers, for means and deviations.
std::vector<double*> membersOf(MonteCarloFigures& f) {
  std::vector<double*> out;
  for (int a = 0; a < 2; ++a) {
    out.insert(out.end(), {&f.nis[a][0], &f.nis[a][1], &f.chi2[a], &f.least[a], &f.sequential[a]});
  }
  return out;
}

std::string percentOf(double share) { return fmt::format("{:.1f}", 100 * share); }

StudyTable comparison(const MonteCarloResult& r, const char* name, const char* title) {
  StudyTable t;
  t.name = name;
  t.title = title;
  t.columns = {"quantity", "paper", "mean", "deviation over experiments"};
  const auto row = [&](const char* what, const char* paper, double mean, double sd) {
    t.rows.push_back({what, paper, fmt::format("{:.3f}", mean), fmt::format("{:.3f}", sd)});
  };
  const auto &m = r.mean, &d = r.deviation;
  row("cyclist track, cyclist filter: mean NIS", "2.0897", m.nis[0][0], d.nis[0][0]);
  row("cyclist track, pedestrian filter: mean NIS", "7.9631", m.nis[0][1], d.nis[0][1]);
  row("pedestrian track, cyclist filter: mean NIS", "1.5916", m.nis[1][0], d.nis[1][0]);
  row("pedestrian track, pedestrian filter: mean NIS", "1.8784", m.nis[1][1], d.nis[1][1]);
  row("cyclists right, chi-square density [%]", "100", 100 * m.chi2[0], 100 * d.chi2[0]);
  row("pedestrians right, chi-square density [%]", "79", 100 * m.chi2[1], 100 * d.chi2[1]);
  row("cyclists right, smallest NIS [%]", "", 100 * m.least[0], 100 * d.least[0]);
  row("pedestrians right, smallest NIS [%]", "", 100 * m.least[1], 100 * d.least[1]);
  row("cyclists right, sequential likelihood [%]", "", 100 * m.sequential[0],
      100 * d.sequential[0]);
  row("pedestrians right, sequential likelihood [%]", "", 100 * m.sequential[1],
      100 * d.sequential[1]);
  row("balanced, sequential likelihood [%]", "", 50 * (m.sequential[0] + m.sequential[1]),
      50 * std::hypot(d.sequential[0], d.sequential[1]));
  return t;
}

StudyPlot traces(const MonteCarloResult& r) {
  StudyPlot plot;
  plot.name = "traces";
  plot.caption =
      "Mean normalized innovation squared of each simulated track in both filters, as in the "
      "figure of Radecki et al.: above for tracks of cyclists, below for tracks of pedestrians. "
      "Dashed: 1.986, the median for the right filter.";
  std::string data[2];
  for (const int kind : {kCyclist, kPedestrian}) {
    const auto& own = r.traces[kind];
    for (std::size_t i = 0; i < own.size(); ++i)
      data[kind] += fmt::format("{} {:.4f} {:.4f}\n", i + 1, own[i][0], own[i][1]);
  }
  plot.data = {{"traces_cyclist.dat", data[0]}, {"traces_pedestrian.dat", data[1]}};
  plot.script = "set multiplot layout 2,1\nset grid\nset yrange [0:*]\nset ylabel 'mean NIS'\n";
  for (const char* kind : {"cyclist", "pedestrian"}) {
    plot.script += fmt::format(
        "set title 'simulated tracks of {0}s'\nset xlabel 'iteration'\n"
        "plot 'traces_{0}.dat' using 1:2 with lines lc rgb '{2}' lw 2 title 'cyclist filter', "
        "'' using 1:3 with lines lc rgb '{3}' lw 2 title 'pedestrian filter', "
        "{1} with lines lc rgb 'black' dt 2 lw 2 title '{1}'\n",
        kind, kMedian, hexOf(colorOfClass("cyclist", 0)), hexOf(colorOfClass("pedestrian", 0)));
  }
  plot.script += "unset multiplot\n";
  plot.height = 800;
  return plot;
}

StudyTable countsTable(const MonteCarloResult& r) {
  StudyTable t;
  t.name = "by_count";
  t.title = "Share right after so many measurements [%]";
  t.columns = {"measurements", "chi-square: cyclists", "chi-square: pedestrians",
               "sequential: cyclists", "sequential: pedestrians"};
  for (const auto& c : r.by_count) {
    t.rows.push_back({std::to_string(c.count), percentOf(c.chi2[0]), percentOf(c.chi2[1]),
                      percentOf(c.sequential[0]), percentOf(c.sequential[1])});
  }
  return t;
}

}  // namespace

MonteCarloResult runMonteCarlo(const MonteCarloParams& p) {
  const auto repeats = static_cast<std::size_t>(p.repeats);
  const auto iterations = static_cast<std::size_t>(p.iterations);
  std::vector<PaperTrack> tracks[2];
  for (const int kind : {kCyclist, kPedestrian}) {
    tracks[kind].resize(repeats * iterations);
    tbb::parallel_for(std::size_t{0}, tracks[kind].size(),
                      [&](std::size_t i) { tracks[kind][i] = makeTrack(p, kind, i); });
  }
  MonteCarloResult r;
  const auto steps = static_cast<std::size_t>(p.steps);
  const auto share = 1.0 / static_cast<double>(iterations);
  for (std::size_t e = 0; e < repeats; ++e) {
    MonteCarloFigures f;
    for (const int kind : {kCyclist, kPedestrian}) {
      const int other = 1 - kind;
      for (std::size_t i = e * iterations; i < (e + 1) * iterations; ++i) {
        const PaperTrack& t = tracks[kind][i];
        for (const int filter : {kCyclist, kPedestrian})
          f.nis[kind][filter] += share * t.meanNis(filter, steps);
        f.chi2[kind] += t.logChi2(kind, steps) > t.logChi2(other, steps) ? share : 0;
        f.least[kind] += t.meanNis(kind, steps) < t.meanNis(other, steps) ? share : 0;
        f.sequential[kind] += t.sequential(kind, steps) > t.sequential(other, steps) ? share : 0;
        if (e == 0)
          r.traces[kind].push_back({t.meanNis(kCyclist, steps), t.meanNis(kPedestrian, steps)});
      }
    }
    r.experiments.push_back(f);
  }
  const auto mean = membersOf(r.mean), deviation = membersOf(r.deviation);
  for (auto& f : r.experiments) {
    const auto own = membersOf(f);
    for (std::size_t m = 0; m < mean.size(); ++m)
      *mean[m] += *own[m] / static_cast<double>(repeats);
  }
  for (auto& f : r.experiments) {
    const auto own = membersOf(f);
    for (std::size_t m = 0; m < mean.size(); ++m)
      *deviation[m] += std::pow(*own[m] - *mean[m], 2) / std::max(1.0, double(repeats) - 1);
  }
  for (double* d : deviation) *d = std::sqrt(*d);
  for (const int count : kCounts) {
    if (count > p.steps) break;
    MonteCarloResult::ByCount c;
    c.count = count;
    const auto n = static_cast<std::size_t>(count);
    for (const int kind : {kCyclist, kPedestrian}) {
      for (const PaperTrack& t : tracks[kind]) {
        const double one = 1.0 / static_cast<double>(tracks[kind].size());
        c.chi2[kind] += t.logChi2(kind, n) > t.logChi2(1 - kind, n) ? one : 0;
        c.sequential[kind] += t.sequential(kind, n) > t.sequential(1 - kind, n) ? one : 0;
      }
    }
    r.by_count.push_back(c);
  }
  return r;
}

StudyReport monteCarloStudy(MonteCarloParams params) {
  StudyReport report;
  report.title = "Walkers and cyclists told apart by their filters";
  report.data = fmt::format(
      "simulated tracks: {} experiments of {} tracks a class, {} measurements at 1 Hz, seed {}",
      params.repeats, params.iterations, params.steps, params.seed);
  params.noise_per_track = false;
  const auto fixed = runMonteCarlo(params);
  params.noise_per_track = true;
  const auto drawn = runMonteCarlo(params);
  report.tables = {
      comparison(fixed, "fixed_noise",
                 "Measurement noise [1.2 .1; .1 1.2] m^2, receiver of Radecki et al."),
      comparison(drawn, "noise_per_track",
                 "Measurement sigma drawn per track from U(.5, 1.7) m and known to the filters"),
      countsTable(fixed)};
  report.plots = {traces(fixed)};
  report.remarks = {
      "The table of Radecki et al. is one experiment of 100 tracks a class; its numbers should lie "
      "within two or three deviations of the mean.",
      "The first innovation is zero, since the first measurement starts the filters: the mean NIS "
      "of the right filter is below 2.",
      "The chi-square density asks which filter's innovations have the size that they should have; "
      "the sequential likelihood uses how small a size each filter promises, too."};
  return report;
}

}  // namespace perception
