// The whole filter under the load of a paper's vehicle in a busy street (simulated measurements):
// 66 objects, a lidar that sees them all 12 times a second, eight radars with 8 returns 20 times a
// second, a camera with 10 boxes 10 times a second. One thread; CPU clock.
// With --plot the figures go into FILE.csv and a picture FILE.png of cost against particles.
#include <fmt/format.h>
#include <malloc.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "libperception/evaluation/plots/Gnuplot.h"
#include "libperception/evaluation/plots/PlotScript.h"
#include "libperception/filter/CRbpfTracker.h"
#include "libperception/measurement/models/MeasurementModel.h"
#include "libperception/pipeline/Pipeline.h"
#include "tests/bench/speed/CpuClock.h"

namespace perception {
namespace {

constexpr int kObjects = 66;

/// What the heap holds [kB].
double heapKb() { return static_cast<double>(mallinfo2().uordblks) / 1024; }

/// What the banks hold, which have an allocator of their own [kB].
double banksKb(const CRbpfTracker& tracker) {
  std::set<const Track*> tracks;
  for (const auto& particle : tracker.m_particles)
    for (const auto& track : particle.d->tracks) tracks.insert(track.get());
  std::size_t filters = 0;
  for (const Track* track : tracks) filters += track->bank.capacity();
  return static_cast<double>(filters * sizeof(ClassFilter)) / 1024;
}

struct Unit {
  std::string label;
  std::shared_ptr<const MeasurementModel> model;
  Modality modality = Modality::kLidar;
  Pose3 T_ego_sensor = Pose3::Identity();
  double rate = 10;  // [1/s]
  int returns = kObjects;
  std::vector<double> sigma;  // by axis
  AxisMask seen = 7;
  int labels = 2;
};

struct Object {
  ClassId c = 0;
  Vector2 start, velocity;
  Extent extent;
  Kinematics at(double t) const {
    Kinematics k;
    k.q << start.x() + velocity.x() * t, start.y() + velocity.y() * t, velocity.x(), velocity.y(),
        std::atan2(velocity.y(), velocity.x());
    k.has_yaw = c != 0;
    return k;
  }
};

/// Objects at least `spacing` meters apart in a disc of 60 m: people and vehicles by turns.
std::vector<Object> street(const ClassTable& classes, double spacing, Rng& rng) {
  std::vector<Object> objects;
  while (objects.size() < kObjects) {
    Object o;
    o.start = {rng.uniform(-60, 60), rng.uniform(-60, 60)};
    if (o.start.norm() > 60 || o.start.norm() < 5) continue;
    const bool near = std::any_of(objects.begin(), objects.end(), [&](const Object& other) {
      return (other.start - o.start).norm() < spacing;
    });
    if (near) continue;
    o.c = static_cast<ClassId>(objects.size() % 3);  // pedestrian, cyclist, car
    const double heading = rng.uniform(-kPi, kPi), speed = o.c == 0 ? 1.2 : 4.0;
    o.velocity = speed * Vector2(std::cos(heading), std::sin(heading));
    o.extent.length = classes[o.c].length;
    o.extent.width = classes[o.c].width;
    objects.push_back(o);
  }
  return objects;
}

std::vector<Unit> vehicle(const PipelineSetup& setup) {
  std::vector<Unit> units;
  int radar = 0;
  for (const auto& s : setup.sensors) {
    if (!s.active) continue;
    SensorFrame nothing;
    if (s.params.modality == Modality::kLidar) {
      nothing.data = LidarCloud{};
    } else if (s.params.modality == Modality::kCamera) {
      nothing.data = ObjectDetections{};
    } else {
      nothing.data = RadarReturns{};
    }
    Unit u;
    u.label = s.label;
    u.model = s.front_end->extract(nothing).model;
    u.modality = s.params.modality;
    if (s.params.modality == Modality::kLidar) {
      u.rate = 12;
      u.sigma = {radians(0.5), radians(0.5), 0.15};
    } else if (s.params.modality == Modality::kCamera) {
      u.rate = 10, u.returns = 10;
      u.sigma = {radians(1.0), radians(1.0), 1.0};
    } else {
      u.rate = 20, u.returns = 8, u.labels = 1;
      u.sigma = {0.5, radians(2), 0.3};
      u.T_ego_sensor = makePose(0, 0, 0.5, radians(45.0 * radar++), 0, 0);
    }
    units.push_back(u);
  }
  return units;
}

MeasurementScan measure(const Unit& u, const std::vector<Object>& objects, double t, Rng& rng) {
  MeasurementScan scan;
  scan.sensor = u.label;
  scan.modality = u.modality;
  scan.model = u.model;
  scan.state.stamp = scan.state.ego.stamp = Stamp::fromSeconds(1000 + t);
  scan.state.T_world_sensor = u.T_ego_sensor;
  std::vector<std::size_t> order(objects.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[rng.below(static_cast<std::uint32_t>(i))]);
  for (const std::size_t i : order) {
    if (static_cast<int>(scan.measurements.size()) == u.returns) break;
    const Kinematics k = objects[i].at(t);
    if (u.model->detectionProbability(objects[i].c, k, objects[i].extent, scan.state, 1) <
        0.5 * rng.uniform())
      continue;
    std::vector<Kinematics> batch(static_cast<std::size_t>(objects[i].c) + 1, k);
    std::vector<Extent> extents(batch.size(), objects[i].extent);
    std::vector<AxisPrediction> h(batch.size());
    u.model->predict(batch.data(), extents.data(), batch.size(), scan.state, h.data());
    if (!h.back().defined) continue;
    Measurement m;
    m.z = h.back().h;
    const auto axes = static_cast<std::size_t>(m.z.size());
    m.R = AxisMatrix::Zero(m.z.size(), m.z.size());
    for (std::size_t a = 0; a < axes; ++a) {
      const auto row = static_cast<Eigen::Index>(a);
      m.z[row] += u.sigma[a] * rng.normal();
      m.R(row, row) = u.sigma[a] * u.sigma[a];
    }
    m.seen = u.seen;
    m.label = u.labels > 1 && objects[i].c == 0 ? 1 : 0;
    m.position = k.q.head<2>();
    m.position_sigma = 1;
    scan.measurements.push_back(std::move(m));
  }
  return scan;
}

struct Event {
  double t;
  std::size_t unit;
};

std::vector<MeasurementScan> logOf(const std::vector<Unit>& units,
                                   const std::vector<Object>& objects, double seconds) {
  std::vector<Event> events;
  for (std::size_t u = 0; u < units.size(); ++u) {
    for (double t = 0.001 * static_cast<double>(u); t < seconds; t += 1 / units[u].rate)
      events.push_back({t, u});
  }
  std::stable_sort(events.begin(), events.end(),
                   [](const Event& a, const Event& b) { return a.t < b.t; });
  Rng rng({3, 0, 0, 0});
  std::vector<MeasurementScan> scans;
  for (const Event& e : events) scans.push_back(measure(units[e.unit], objects, e.t, rng));
  return scans;
}

const char* nameOf(Proposal p) { return p == Proposal::kSampled ? "sampled" : "ranked"; }

/// What one setting costs.
struct Load {
  std::string street, proposal;
  int particles = 0;
  double real_time = 0;              // seconds of log per CPU second
  double p50 = 0, p99 = 0, max = 0;  // [ms] a message
  double distinct = 0, hypotheses = 0, objects = 0, kilobytes = 0;
};

/// Once through the log; of each message the least time so far stays in `times` [ms].
Load runOnce(const std::vector<MeasurementScan>& scans, const FilterModel& model, int particles,
             std::vector<double>& times) {
  ParticleFilterParams pf;
  pf.sample_size = particles;
  const double before = heapKb();
  CRbpfTracker tracker(model, pf.toMrpt(), 1);
  Load load;
  const auto n = static_cast<double>(scans.size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const double begin = test::cpuSeconds();
    tracker.process(scans[i]);
    times[i] = std::min(times[i], 1e3 * (test::cpuSeconds() - begin));
    load.distinct += static_cast<double>(tracker.stats().distinct_tracks) / n;
    load.hypotheses += static_cast<double>(tracker.stats().hypotheses) / n;
    load.objects = static_cast<double>(tracker.mapHypothesis().tracks.size());
  }
  load.kilobytes = heapKb() - before + banksKb(tracker);
  return load;
}

Load run(const char* street_name, const std::vector<MeasurementScan>& scans, FilterModel model,
         Proposal proposal, int particles, int rounds, double seconds) {
  model.proposal = proposal;
  std::vector<double> times(scans.size(), std::numeric_limits<double>::infinity());
  Load load;
  for (int round = 0; round < rounds; ++round) load = runOnce(scans, model, particles, times);
  load.street = street_name, load.proposal = nameOf(proposal), load.particles = particles;
  std::sort(times.begin(), times.end());
  load.real_time = 1e3 * seconds / std::accumulate(times.begin(), times.end(), 0.0);
  load.p50 = times[times.size() / 2];
  load.p99 = times[static_cast<std::size_t>(0.99 * static_cast<double>(times.size()))];
  load.max = times.back();
  return load;
}

void print(const Load& l) {
  fmt::print(
      "{:<8} {:<8} {:>5}  {:>7.2f}  {:>7.3f} {:>7.3f} {:>7.3f}  {:>7.1f} {:>7.1f} {:>5.0f} "
      "{:>7.0f}\n",
      l.street, l.proposal, l.particles, l.real_time, l.p50, l.p99, l.max, l.distinct, l.hypotheses,
      l.objects, l.kilobytes);
  std::fflush(stdout);
}

/// The figures as CSV and cost against particles as a picture, one panel a street.
void draw(const std::vector<Load>& loads, const std::string& file) {
  const std::filesystem::path stem(file);
  const std::string dir = stem.has_parent_path() ? stem.parent_path().string() : ".";
  const std::string name = stem.filename().string();
  std::string csv =
      "street,proposal,particles,real_time,p50_ms,p99_ms,max_ms,distinct,hypotheses\n";
  for (const Load& l : loads)
    csv += fmt::format("{},{},{},{:.3f},{:.4f},{:.4f},{:.4f},{:.1f},{:.1f}\n", l.street, l.proposal,
                       l.particles, l.real_time, l.p50, l.p99, l.max, l.distinct, l.hypotheses);
  std::string gp = fmt::format(
      "set terminal pngcairo size 1200,560 font 'DejaVu Sans,12'\nset output {}\n"
      "set datafile separator ','\nset multiplot layout 1,2 title "
      "'CPU time of a message: 66 objects, ten sensors, 182 messages a second (simulated)'\n"
      "set logscale xy\nset xrange [0.8:1300]\nset yrange [0.05:30]\nset grid\n"
      "set xlabel 'particles'\nset ylabel 'CPU time a message [ms]'\nset key top left\n"
      "set xtics (1, 8, 64, 256, 1000)\nset arrow from 0.8,5 to 1300,5 nohead lc rgb '{}' dt 3\n"
      "set label 'limit 5 ms' at 0.9,5.7 left tc rgb '#555555'\n",
      gnuplotString(name + ".png"), plot_color::kGray);
  for (const char* street : {"open", "crowded"}) {
    gp += fmt::format("set title '{}'\nplot ", std::string(street) == "open"
                                                   ? "open street: little ambiguity (4 m apart)"
                                                   : "crowded street: much ambiguity (1 m apart)");
    for (const char* proposal : {"sampled", "ranked"}) {
      const std::string color =
          std::string(proposal) == "sampled" ? plot_color::kBlue : plot_color::kOrange;
      for (const auto& [column, label, dash] :
           {std::tuple{6, "p99", 1}, std::tuple{5, "median", 2}}) {
        gp += fmt::format(
            "{} using 3:((strcol(1) eq '{}' && strcol(2) eq '{}') ? ${} : NaN) with linespoints "
            "pt 7 lw 2 dt {} lc rgb '{}' title '{}, {}', ",
            gnuplotString(name + ".csv"), street, proposal, column, dash, color, proposal, label);
      }
    }
    gp += "\n";
  }
  std::ofstream(dir + "/" + name + ".csv") << csv;
  std::ofstream(dir + "/" + name + ".gp") << gp;
  const std::string fault = runGnuplot(dir, name + ".gp");
  if (!fault.empty()) fmt::print(stderr, "{}\n", fault);
}

}  // namespace
}  // namespace perception

int main(int argc, char** argv) {
  using namespace perception;
  CLI::App app("The whole filter under load");
  double seconds = 5;
  std::vector<int> counts = {1, 8, 64, 256, 1000};
  std::string only, plot;
  int rounds = 3;
  app.add_option("seconds", seconds, "of log");
  app.add_option("--particles", counts, "counts")->delimiter(',');
  app.add_option("--only", only, "sampled or ranked");
  app.add_option("--rounds", rounds, "the least time of each message counts");
  app.add_option("--plot", plot, "FILE: writes FILE.csv and FILE.png");
  CLI11_PARSE(app, argc, argv);
  tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  Config config = Config::fromFile(PERCEPTION_SOURCE_DIR "/ini/skynet.ini");
  const PipelineSetup setup = PipelineSetup::read(config);
  config.finish();
  const auto units = vehicle(setup);
  fmt::print("{} sensors, {} objects, {} classes, {} s (simulated measurements), one thread\n",
             units.size(), kObjects, setup.model.classes.size(), seconds);
  fmt::print(
      "street   proposal  part.  x real   ms p50     p99     max  distinct hypoth. tracks      "
      "kB\n");
  std::vector<Load> loads;
  for (const double spacing : {4.0, 1.0}) {
    Rng rng({static_cast<std::uint64_t>(spacing), 1, 0, 0});
    const auto objects = street(setup.model.classes, spacing, rng);
    const auto scans = logOf(units, objects, seconds);
    for (const Proposal p : {Proposal::kSampled, Proposal::kRanked}) {
      if (!only.empty() && only != nameOf(p)) continue;
      for (const int particles : counts) {
        loads.push_back(run(spacing > 2 ? "open" : "crowded", scans, setup.model, p, particles,
                            rounds, seconds));
        print(loads.back());
      }
    }
  }
  if (!plot.empty()) draw(loads, plot);
}
