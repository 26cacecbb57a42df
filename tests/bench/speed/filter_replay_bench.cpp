// The filter alone on a log's scans: front ends and output do not count. The log is read once;
// every number of particles replays the very same measurements. One thread; CPU clock.
//   filter_replay_bench INI LOG... [--particles 8,100] [--proposal ranked] [--seconds 0] [--rounds
//   3]
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "libperception/pipeline/Pipeline.h"
#include "libperception/pipeline/input/LogRecorder.h"
#include "tests/bench/speed/CpuClock.h"

namespace perception {
namespace {

struct Replayed {
  std::vector<double> ms;  // by scan
  double distinct = 0, predicted = 0, pairs = 0, updates = 0, hypotheses = 0, measurements = 0;
  std::uint64_t structure = 14695981039346656037ull;  // of the histories in the output
  double sum = 0;                                     // of their existence and place
};

Replayed replayTimed(const RecordedLog& log, Proposal proposal, int particles) {
  FilterModel model = log.model;
  model.proposal = proposal;
  ParticleFilterParams pf = log.particles;
  pf.sample_size = particles;
  CRbpfTracker tracker(model, pf.toMrpt(), 1);
  Replayed out;
  for (const auto& entry : log.entries) {
    if (entry.kind == RecordedLog::Entry::kRestart) tracker.reset();
    if (entry.kind != RecordedLog::Entry::kScan) continue;
    const double begin = test::cpuSeconds();
    tracker.process(*entry.scan);
    out.ms.push_back(1e3 * (test::cpuSeconds() - begin));
    const ScanStats& s = tracker.stats();
    out.distinct += static_cast<double>(s.distinct_tracks);
    out.predicted += static_cast<double>(s.predicted);
    out.pairs += static_cast<double>(s.pairs);
    out.updates += static_cast<double>(s.updates);
    out.hypotheses += static_cast<double>(s.hypotheses);
    out.measurements += static_cast<double>(s.measurements);
    for (const auto& t : tracker.mapHypothesis().tracks) {
      out.structure = (out.structure ^ t->history) * 1099511628211ull;
      const ClassFilter& f = t->bank[static_cast<std::size_t>(t->likeliestClass())];
      out.sum += t->existence + f.x[0] + f.x[1];
    }
  }
  return out;
}

void report(const RecordedLog& log, Proposal proposal, int particles, int rounds) {
  Replayed best;
  std::vector<double> least;
  for (int round = 0; round < rounds; ++round) {  // the machine's other work only adds
    best = replayTimed(log, proposal, particles);
    if (least.empty()) least = best.ms;
    for (std::size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], best.ms[i]);
  }
  double mean = 0;
  for (const double t : least) mean += t;
  const auto n = static_cast<double>(least.size());
  mean /= n;
  std::sort(least.begin(), least.end());
  fmt::print(
      "{:<12} {:>5}  {:>8.4f} {:>8.4f} {:>8.4f} {:>8.4f}  {:>7.1f} {:>7.1f} {:>7.1f} {:>7.1f} "
      "{:>7.1f} {:>7.1f}  {:016x} {:.9g}\n",
      log.name, particles, mean, least[least.size() / 2], least[static_cast<std::size_t>(.99 * n)],
      least.back(), best.measurements / n, best.hypotheses / n, best.distinct / n,
      best.predicted / n, best.pairs / n, best.updates / n, best.structure, best.sum);
  std::fflush(stdout);
}

}  // namespace
}  // namespace perception

int main(int argc, char** argv) {
  using namespace perception;
  CLI::App app("The filter's time on a log's scans");
  std::string ini, proposal = "ranked";
  std::vector<std::string> logs;
  std::vector<int> particles = {8, 100};
  double seconds = 0;
  int rounds = 3;
  app.add_option("ini", ini, "configuration of the run");
  app.add_option("logs", logs, "rawlogs");
  app.add_option("--particles", particles, "counts")->delimiter(',');
  app.add_option("--proposal", proposal, "sampled, ranked or nearest");
  app.add_option("--seconds", seconds, "of each log; 0: all");
  app.add_option("--rounds", rounds, "the least time of each scan counts");
  CLI11_PARSE(app, argc, argv);
  if (logs.empty()) {
    fmt::print("skipped: needs a configuration and a log\n");
    return 0;
  }
  const auto& names = RunParams::associationNames();
  const auto found = std::find(names.begin(), names.end(), proposal);
  if (found == names.end()) return 64;
  tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  fmt::print(
      "log          part.   ms mean      p50      p99      max    meas. hypoth. distinct predict.  "
      " pairs updates  output\n");
  for (const std::string& path : logs) {
    Config config = Config::fromFile(ini);
    const RecordedLog log = recordLog(path, config, seconds);
    for (const int n : particles)
      report(log, static_cast<Proposal>(found - names.begin()), n, rounds);
  }
}
