// Time of weather/trust/PointTrust against dynamic radius outlier removal on a kd-tree (nanoflann),
// on WADS's scans (real snow, 210k returns, of 128 beams). Scans outer, methods inner, CPU clock;
// the scores of the same run beside it, so that speed is not bought with errors.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <ctime>
#include <vector>

#include "libperception/weather/trust/PointTrust.h"
#include "tests/bench/quality/SnowFilters.h"
#include "tests/support/LabeledScans.h"

namespace perception {
namespace {

double cpuMilliseconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(q * static_cast<double>(values.size())))];
}

int run() {
  auto scans = test::labeledScans(std::string(PERCEPTION_SHARED_DATA) + "/data/wads_snow", 2.17);
  if (scans.empty()) {
    fmt::print("no recordings\n");
    return 0;
  }
  const auto trust = makePointTrust(TrustParams{});
  const auto dror = bench::makeDror({});
  std::vector<double> ours, peer, ratio;
  test::PhantomScore our_score, peer_score;
  double returns = 0;
  for (auto& scan : scans) {
    SensorFrame a = scan.frame, b = scan.frame;
    const double t0 = cpuMilliseconds();
    trust->apply(a);
    const double t1 = cpuMilliseconds();
    dror->apply(b);
    const double t2 = cpuMilliseconds();
    const double per_200k = 2e5 / static_cast<double>(scan.labels.size());
    ours.push_back((t1 - t0) * per_200k), peer.push_back((t2 - t1) * per_200k);
    ratio.push_back(peer.back() / ours.back());
    our_score.add(scan, std::get<LidarCloud>(a.data).trust, test::kSnowLabel);
    peer_score.add(scan, std::get<LidarCloud>(b.data).trust, test::kSnowLabel);
    returns += static_cast<double>(scan.labels.size());
  }
  fmt::print("{} scans of {:.0f} returns; ms CPU per 200k returns, median (p99)\n", scans.size(),
             returns / static_cast<double>(scans.size()));
  fmt::print("point trust {:.2f} ({:.2f}), F1 {:.4f}\nDROR, kd-tree {:.1f} ({:.1f}), F1 {:.4f}\n",
             quantile(ours, 0.5), quantile(ours, 0.99), our_score.f1(), quantile(peer, 0.5),
             quantile(peer, 0.99), peer_score.f1());
  fmt::print("ratio {:.1f} (p1 {:.1f}); goals 5 ms, 20\n", quantile(ratio, 0.5),
             quantile(ratio, 0.01));
  return 0;
}

}  // namespace
}  // namespace perception

int main() { return perception::run(); }
