#include "libperception/doctor/motion/MotionFit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "libperception/core/math/Median.h"

namespace perception {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kSteps = 15;
constexpr std::size_t kBlocks = 10;       ///< of the jackknife
constexpr std::size_t kFewestItems = 20;  ///< items
constexpr double kNormal = 1.4826;  ///< standard deviation of a Gaussian by its median deviation
/// [standard deviations] scale of Cauchy's weight: 95 % efficient for Gaussian noise.
constexpr double kCauchy = 2.385;

struct Block {
  MatrixXd H;
  VectorXd g;
};

/// Residuals of the items that have any at these parameters.
std::vector<std::pair<std::size_t, VectorXd>> residualsAt(const FitProblem& p, const VectorXd& x) {
  std::vector<std::pair<std::size_t, VectorXd>> out;
  VectorXd r(p.rows);
  for (std::size_t k = 0; k < p.items; ++k)
    if (p.residuals(k, x, r) && r.allFinite()) out.emplace_back(k, r);
  return out;
}

VectorXd noiseOf(const FitProblem& p, const std::vector<std::pair<std::size_t, VectorXd>>& all) {
  VectorXd noise(p.rows);
  std::vector<double> sizes(all.size());
  for (Eigen::Index row = 0; row < p.rows; ++row) {
    for (std::size_t i = 0; i < all.size(); ++i) sizes[i] = std::abs(all[i].second[row]);
    noise[row] = std::max(p.least[row], kNormal * medianOf(sizes));
  }
  return noise;
}

/// Normal equations of the items, without the prior, in blocks of time.
std::vector<Block> normalBlocks(const FitProblem& p, const VectorXd& x,
                                const std::vector<std::pair<std::size_t, VectorXd>>& all) {
  const VectorXd noise = noiseOf(p, all);
  const Eigen::Index n = x.size();
  std::vector<Block> blocks(kBlocks, {MatrixXd::Zero(n, n), VectorXd::Zero(n)});
  VectorXd moved(p.rows);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const VectorXd& r = all[i].second;
    MatrixXd J(p.rows, n);
    bool complete = true;
    for (Eigen::Index j = 0; j < n && complete; ++j) {
      VectorXd y = x;
      y[j] += p.step[j];
      complete = p.residuals(all[i].first, y, moved);
      J.col(j) = (moved - r) / p.step[j];
    }
    if (!complete || !J.allFinite()) continue;
    Block& block = blocks[i * kBlocks / all.size()];
    for (Eigen::Index row = 0; row < p.rows; ++row) {
      const double u = r[row] / noise[row];
      const double w = 1 / ((1 + u * u / (kCauchy * kCauchy)) * noise[row] * noise[row] * p.shared);
      block.H += w * J.row(row).transpose() * J.row(row);
      block.g -= w * J.row(row).transpose() * r[row];
    }
  }
  return blocks;
}

/// Change of the estimate without each block, one step of Newton's method.
VectorXd jackknife(const std::vector<Block>& blocks, const MatrixXd& H, const VectorXd& g) {
  VectorXd squares = VectorXd::Zero(g.size());
  for (const Block& block : blocks) {
    const VectorXd change = (H - block.H).ldlt().solve(g - block.g);
    squares += change.cwiseAbs2();
  }
  const auto n = static_cast<double>(blocks.size());
  return ((n - 1) / n * squares).cwiseSqrt();
}

}  // namespace

std::optional<FitResult> fitRobustly(const FitProblem& p) {
  FitResult result;
  result.value = p.start;
  const VectorXd information = p.sigma.cwiseAbs2().cwiseInverse();
  for (int i = 0; i <= kSteps; ++i) {
    const auto all = residualsAt(p, result.value);
    if (all.size() < kFewestItems) return std::nullopt;
    const std::vector<Block> blocks = normalBlocks(p, result.value, all);
    MatrixXd H = information.asDiagonal();
    VectorXd g = information.cwiseProduct(p.mean - result.value);
    for (const Block& block : blocks) H += block.H, g += block.g;
    if (i == kSteps) {
      const VectorXd formal =
          H.ldlt().solve(MatrixXd::Identity(H.rows(), H.cols())).diagonal().cwiseSqrt();
      result.sigma = formal.cwiseMax(jackknife(blocks, H, g));
      result.used = all.size();
      break;
    }
    result.value += H.ldlt().solve(g);
  }
  if (!result.value.allFinite() || !result.sigma.allFinite()) return std::nullopt;
  return result;
}

}  // namespace perception
