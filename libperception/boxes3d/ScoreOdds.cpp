#include "libperception/boxes3d/ScoreOdds.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace perception {

ScoreOdds fitScoreOdds(const std::vector<BoxSample>& samples, double ridge) {
  constexpr int kSteps = 30;
  if (samples.empty()) return {};
  const auto rowOf = [](const BoxSample& s) { return Eigen::Vector3d(1, s.score, s.range); };
  // Standardized columns, so that one ridge penalty fits both.
  Eigen::Vector3d spread = Eigen::Vector3d::Zero();
  for (const BoxSample& s : samples) spread += rowOf(s).cwiseAbs2();
  spread = (spread / static_cast<double>(samples.size())).cwiseSqrt().cwiseMax(1e-9);
  spread[0] = 1;
  const Eigen::Vector3d penalty(1e-6, ridge, ridge);
  Eigen::Vector3d w = Eigen::Vector3d::Zero();
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Vector3d gradient = -penalty.cwiseProduct(w);
    Eigen::Matrix3d hessian = penalty.asDiagonal();
    for (const BoxSample& s : samples) {
      const Eigen::Vector3d x = rowOf(s).cwiseQuotient(spread);
      const double p = 1 / (1 + std::exp(-w.dot(x)));
      gradient += ((s.object ? 1 : 0) - p) * x;
      hessian += p * (1 - p) * x * x.transpose();
    }
    const Eigen::Vector3d change = hessian.ldlt().solve(gradient);
    w += change;
    if (change.norm() < 1e-9) break;
  }
  w = w.cwiseQuotient(spread);
  return {w[1] != 0 ? -w[0] / w[1] : 0, w[1], -w[2]};
}

double logLoss(const ScoreOdds& odds, const std::vector<BoxSample>& samples) {
  double sum = 0;
  for (const BoxSample& s : samples) {
    const double log_odds = odds.logOdds(s.score, s.range);
    const double against = s.object ? -log_odds : log_odds;
    sum += against > 30 ? against : std::log1p(std::exp(against));
  }
  return samples.empty() ? 0 : sum / static_cast<double>(samples.size());
}

}  // namespace perception
