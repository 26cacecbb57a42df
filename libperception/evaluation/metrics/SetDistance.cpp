#include "libperception/evaluation/metrics/SetDistance.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "libperception/core/math/Assignment.h"

namespace perception {
namespace {

// The squared distances, cut off, of the best complete assignment of the smaller set. It is optimal
// for GOSPA with alpha = 2, too: there a pair at the cut-off costs what a missed and a false object
// cost.
std::vector<double> assignedSquares(const std::vector<Vector2>& truth,
                                    const std::vector<Vector2>& estimates, double cutoff) {
  if (truth.empty() || estimates.empty()) return {};
  Eigen::MatrixXd cost(static_cast<Eigen::Index>(truth.size()),
                       static_cast<Eigen::Index>(estimates.size()));
  for (Eigen::Index r = 0; r < cost.rows(); ++r) {
    for (Eigen::Index c = 0; c < cost.cols(); ++c) {
      const Vector2 d = truth[static_cast<std::size_t>(r)] - estimates[static_cast<std::size_t>(c)];
      cost(r, c) = std::min(d.squaredNorm(), cutoff * cutoff);
    }
  }
  std::vector<double> squares;
  const std::vector<int> columns = optimalAssignment(cost);
  for (std::size_t r = 0; r < columns.size(); ++r) {
    if (columns[r] >= 0) squares.push_back(cost(static_cast<Eigen::Index>(r), columns[r]));
  }
  return squares;
}

}  // namespace

double Gospa::value() const { return std::sqrt(squared()); }

Gospa gospa(const std::vector<Vector2>& truth, const std::vector<Vector2>& estimates,
            double cutoff) {
  const double limit = cutoff * cutoff;
  Gospa result;
  for (const double square : assignedSquares(truth, estimates, cutoff)) {
    if (square >= limit) continue;
    result.localization += square;
    ++result.pairs;
  }
  result.missed = limit / 2 * static_cast<double>(truth.size() - result.pairs);
  result.false_ = limit / 2 * static_cast<double>(estimates.size() - result.pairs);
  return result;
}

double ospa(const std::vector<Vector2>& truth, const std::vector<Vector2>& estimates,
            double cutoff) {
  const std::size_t larger = std::max(truth.size(), estimates.size());
  if (larger == 0) return 0;
  const std::vector<double> squares = assignedSquares(truth, estimates, cutoff);
  double sum = cutoff * cutoff * static_cast<double>(larger - squares.size());
  for (const double square : squares) sum += square;
  return std::sqrt(sum / static_cast<double>(larger));
}

}  // namespace perception
