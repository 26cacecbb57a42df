#include "studies/gps/SpeedRegimes.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

/// Lower edges [m/s]: finer at speeds of pedestrians and cyclists.
constexpr std::array<double, SpeedRegimes::kBins> kEdges = {0,   0.3, 0.8, 1.3, 1.8,  2.5, 3.3, 4.2,
                                                            5.2, 6.5, 8,   10,  12.5, 16,  20,  26};
constexpr double kKernel = 0.7;           // bins: standard deviation of the smoothing
constexpr double kPrior = 0.3;            // transitions a bin, near the diagonal, before any data
constexpr double kReferenceSpeed = 1000;  // number of transitions of a user with weight 1
constexpr int kMixing = 300;              // steps to the stationary distribution

using Matrix = std::array<std::array<double, SpeedRegimes::kBins>, SpeedRegimes::kBins>;

Matrix kernel() {
  Matrix k{};
  for (std::size_t i = 0; i < k.size(); ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < k.size(); ++j) {
      const double d = (static_cast<double>(i) - static_cast<double>(j)) / kKernel;
      sum += k[i][j] = std::exp(-0.5 * d * d);
    }
    for (double& x : k[i]) x /= sum;
  }
  return k;
}

Matrix product(const Matrix& a, const Matrix& b, bool transpose_a) {
  Matrix out{};
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < a.size(); ++k)
      for (std::size_t j = 0; j < a.size(); ++j)
        out[i][j] += (transpose_a ? a[k][i] : a[i][k]) * b[k][j];
  return out;
}

}  // namespace

std::vector<int> SpeedRegimes::binsOf(const std::vector<double>& t, const std::vector<Vector2>& p) {
  std::vector<int> bins;
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    const double speed = (p[i + 1] - p[i]).norm() / (t[i + 1] - t[i]);
    const auto edge = std::upper_bound(kEdges.begin(), kEdges.end(), speed);
    bins.push_back(std::max(0, static_cast<int>(edge - kEdges.begin()) - 1));
  }
  return bins;
}

void SpeedRegimes::add(const std::vector<std::vector<int>>& tracks_of_user) {
  Matrix own{};
  double total = 0;
  for (const auto& bins : tracks_of_user) {
    for (std::size_t i = 0; i + 1 < bins.size(); ++i, ++total)
      ++own[static_cast<std::size_t>(bins[i])][static_cast<std::size_t>(bins[i + 1])];
  }
  if (total == 0) return;
  const double weight = std::sqrt(kReferenceSpeed / total);
  for (std::size_t i = 0; i < own.size(); ++i)
    for (std::size_t j = 0; j < own.size(); ++j) counts_[i][j] += weight * own[i][j];
}

void SpeedRegimes::finish() {
  const Matrix k = kernel();
  Matrix smooth = product(product(k, counts_, true), k, false);
  std::array<double, kBins> share{};
  share[0] = 1;
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < smooth.size(); ++j) sum += smooth[i][j] += kPrior * k[i][j];
    for (double& x : smooth[i]) x /= sum;
  }
  for (int step = 0; step < kMixing; ++step) {
    std::array<double, kBins> next{};
    for (std::size_t i = 0; i < next.size(); ++i)
      for (std::size_t j = 0; j < next.size(); ++j) next[j] += share[i] * smooth[i][j];
    share = next;
  }
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    log_start_[i] = std::log(share[i]);
    for (std::size_t j = 0; j < smooth.size(); ++j) log_transition_[i][j] = std::log(smooth[i][j]);
  }
}

double SpeedRegimes::logLikelihood(const std::vector<int>& bins, std::size_t from,
                                   std::size_t count) const {
  double sum = log_start_[static_cast<std::size_t>(bins[from])];
  for (std::size_t i = from; i + 1 < from + count; ++i)
    sum +=
        log_transition_[static_cast<std::size_t>(bins[i])][static_cast<std::size_t>(bins[i + 1])];
  return sum;
}

}  // namespace perception
