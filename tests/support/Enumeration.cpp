#include "tests/support/Enumeration.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <Eigen/LU>

#include "libperception/filter/state/Track.h"

namespace perception::test {
namespace {

/// A chain of scans at which one object was seen: measurement index or -1 for a miss, from its
/// birth on.
struct Chain {
  std::size_t born = 0;
  std::vector<int> seen;
};

/// log p(z_1..z_n, labels, class j | alive as long as needed) and the final Kalman state; textbook
/// covariance form.
struct KalmanRun {
  double log_likelihood = 0;
  Vector4 x;
  Matrix4 P;
};

KalmanRun runKalman(const Chain& chain, ClassId j, const std::vector<MeasurementScan>& scans,
                    const PositionModel& sensor, const FilterModel& model) {
  const ObjectClass& c = model.classes[j];
  const auto& row = sensor.params().classes[static_cast<std::size_t>(j)];
  const auto noise = [&](const Measurement& m) { return Matrix2(Matrix2(m.R) + row.noise); };
  KalmanRun run;
  const auto& first = scans[chain.born].measurements[static_cast<std::size_t>(chain.seen.front())];
  run.x << first.z[0], first.z[1], 0, 0;
  run.P.setZero();
  run.P.topLeftCorner<2, 2>() = noise(first);
  if (c.motion->moves) {
    const double sigma = std::min(model.params.start_speed_sigma, 0.5 * c.max_speed);
    run.P(2, 2) = run.P(3, 3) = sigma * sigma;
  }
  run.log_likelihood = std::log(sensor.params().births_per_scan / sensor.area() * c.prior *
                                row.labels[static_cast<std::size_t>(first.label)]);
  for (std::size_t i = 1; i < chain.seen.size(); ++i) {
    const auto& scan = scans[chain.born + i];
    const double dt = scan.state.stamp - scans[chain.born + i - 1].state.stamp;
    if (c.motion->moves) {
      Matrix4 F = Matrix4::Identity();
      F(0, 2) = F(1, 3) = dt;
      Matrix4 Q = Matrix4::Zero();
      for (int a = 0; a < 2; ++a) {
        Q(a, a) = c.accel_psd * std::pow(dt, 3) / 3;
        Q(a, a + 2) = Q(a + 2, a) = c.accel_psd * dt * dt / 2;
        Q(a + 2, a + 2) = c.accel_psd * dt;
      }
      run.x = F * run.x;
      run.P = F * run.P * F.transpose() + Q;
    } else {
      run.P(0, 0) += c.position_psd * dt;
      run.P(1, 1) += c.position_psd * dt;
    }
    if (chain.seen[i] < 0) continue;  // misses are weighed with life and death
    const auto& m = scan.measurements[static_cast<std::size_t>(chain.seen[i])];
    const Matrix2 S = run.P.topLeftCorner<2, 2>() + noise(m) + 1e-9 * Matrix2::Identity();
    const Vector2 y = Vector2(m.z) - run.x.head<2>();
    run.log_likelihood += -0.5 * y.dot(S.inverse() * y) - 0.5 * std::log(S.determinant()) -
                          std::log(kTwoPi) +
                          std::log(row.detection * row.labels[static_cast<std::size_t>(m.label)]);
    const Eigen::Matrix<double, 4, 2> K = run.P.leftCols<2>() * S.inverse();
    run.x += K * y;
    run.P -= K * run.P.topRows<2>();
  }
  return run;
}

/// Sums over births, clutter, life and death of one chain: p(chain's measurements) and the
/// posterior of its object.
struct ChainSum {
  double weight = 0;
  ExactPosterior::TrackPosterior posterior;
};

ChainSum sumChain(const Chain& chain, const std::vector<MeasurementScan>& scans,
                  const PositionModel& sensor, const FilterModel& model) {
  const auto last_hit = static_cast<std::size_t>(
      std::find_if(chain.seen.rbegin(), chain.seen.rend(), [](int k) { return k >= 0; }).base() -
      chain.seen.begin() - 1);
  const auto survive = [&](std::size_t i) {
    const double dt = scans[chain.born + i].state.stamp - scans[chain.born + i - 1].state.stamp;
    return std::exp(-dt / model.params.survival_in_view);
  };
  ChainSum sum;
  double alive_total = 0;
  std::vector<double> alive(static_cast<std::size_t>(model.classes.size()));
  Vector2 mean = Vector2::Zero();
  for (ClassId j = 0; j < model.classes.size(); ++j) {
    const double detection = sensor.params().classes[static_cast<std::size_t>(j)].detection;
    const KalmanRun run = runKalman(chain, j, scans, sensor, model);
    double lives = std::exp(run.log_likelihood);  // joint weight of being alive so far
    double dead = 0;
    for (std::size_t i = 1; i < chain.seen.size(); ++i) {
      const double s = survive(i);
      if (i > last_hit) dead += lives * (1 - s);
      lives *= s * (chain.seen[i] < 0 ? 1 - detection : 1);
    }
    alive[static_cast<std::size_t>(j)] = lives;
    alive_total += lives;
    mean += lives * run.x.head<2>();
    sum.weight += lives + dead;
  }
  const auto& first = scans[chain.born].measurements[static_cast<std::size_t>(chain.seen.front())];
  if (last_hit == 0) {  // it may have been clutter
    sum.weight += sensor.params().clutter_per_scan / sensor.area() *
                  sensor.params().clutter_labels[static_cast<std::size_t>(first.label)];
  }
  sum.posterior.existence = alive_total / sum.weight;
  for (const double a : alive) sum.posterior.classes.push_back(a / alive_total);
  sum.posterior.mean = mean / alive_total;
  return sum;
}

std::uint64_t hashOf(const Chain& chain) {
  std::uint64_t h = 0;
  for (std::size_t i = 0; i < chain.seen.size(); ++i) {
    if (chain.seen[i] >= 0)
      h = extendHistory(h, chain.born + i, static_cast<std::size_t>(chain.seen[i]));
  }
  return h;
}

}  // namespace

ExactPosterior enumerateExactly(const std::vector<MeasurementScan>& scans,
                                const PositionModel& sensor, const FilterModel& model) {
  ExactPosterior result;
  std::map<std::vector<std::uint64_t>, double> weights;
  std::vector<Chain> chains;
  // Depth first over scans and their measurements; taken[i]: chain i already has a measurement of
  // this scan.
  std::function<void(std::size_t)> scanFrom;
  std::function<void(std::size_t, std::size_t, std::vector<char>&)> measurementFrom =
      [&](std::size_t s, std::size_t k, std::vector<char>& taken) {
        if (k == scans[s].measurements.size()) {
          scanFrom(s + 1);
          return;
        }
        const std::size_t old = taken.size();
        for (std::size_t i = 0; i < old; ++i) {
          if (taken[i]) continue;
          taken[i] = 1;
          chains[i].seen.back() = static_cast<int>(k);
          measurementFrom(s, k + 1, taken);
          chains[i].seen.back() = -1;
          taken[i] = 0;
        }
        chains.push_back({s, {static_cast<int>(k)}});
        measurementFrom(s, k + 1, taken);
        chains.pop_back();
      };
  scanFrom = [&](std::size_t s) {
    if (s == scans.size()) {
      double weight = 1;
      std::vector<std::uint64_t> key;
      ExactPosterior::History history;
      for (const auto& chain : chains) {
        const ChainSum sum = sumChain(chain, scans, sensor, model);
        weight *= sum.weight;
        key.push_back(hashOf(chain));
        history.tracks[key.back()] = sum.posterior;
      }
      std::sort(key.begin(), key.end());
      history.probability = weight;
      result.histories[key] = history;
      return;
    }
    for (auto& c : chains) c.seen.push_back(-1);
    std::vector<char> taken(chains.size(), 0);
    measurementFrom(s, 0, taken);
    for (auto& c : chains) c.seen.pop_back();
  };
  scanFrom(0);
  double total = 0;
  for (const auto& [key, h] : result.histories) total += h.probability;
  for (auto& [key, h] : result.histories) h.probability /= total;
  result.log_evidence = std::log(total);
  return result;
}

}  // namespace perception::test
