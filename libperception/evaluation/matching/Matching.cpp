#include "libperception/evaluation/matching/Matching.h"

#include <Eigen/Core>

#include "libperception/core/math/Assignment.h"

namespace perception {
namespace {

Eigen::MatrixXd distances(const std::vector<Vector2>& truth,
                          const std::vector<Vector2>& estimates) {
  Eigen::MatrixXd d(static_cast<Eigen::Index>(truth.size()),
                    static_cast<Eigen::Index>(estimates.size()));
  for (Eigen::Index r = 0; r < d.rows(); ++r) {
    for (Eigen::Index c = 0; c < d.cols(); ++c) {
      d(r, c) =
          (truth[static_cast<std::size_t>(r)] - estimates[static_cast<std::size_t>(c)]).norm();
    }
  }
  return d;
}

std::vector<int> closest(const Eigen::MatrixXd& distance) {
  std::vector<int> columns;
  for (Eigen::Index r = 0; r < distance.rows(); ++r) {
    Eigen::Index c = 0;
    distance.row(r).minCoeff(&c);
    columns.push_back(static_cast<int>(c));
  }
  return columns;
}

std::vector<int> oneToOne(const Eigen::MatrixXd& distance, double tolerance) {
  // Pairs beyond the tolerance cost more than the sum of all other pairs, so that the number of
  // pairs is maximized first.
  const double out_of_reach = tolerance * static_cast<double>(distance.rows() + 1) + 1;
  return optimalAssignment((distance.array() <= tolerance).select(distance, out_of_reach));
}

}  // namespace

std::vector<int> match(const std::vector<Vector2>& truth, const std::vector<Vector2>& estimates,
                       double tolerance, Pairing pairing) {
  if (truth.empty() || estimates.empty()) return std::vector<int>(truth.size(), -1);
  const Eigen::MatrixXd distance = distances(truth, estimates);
  std::vector<int> result =
      pairing == Pairing::kClosest ? closest(distance) : oneToOne(distance, tolerance);
  for (std::size_t r = 0; r < result.size(); ++r) {
    // A truth without a place (NaN) matches nothing.
    if (result[r] >= 0 && !(distance(static_cast<Eigen::Index>(r), result[r]) <= tolerance))
      result[r] = -1;
  }
  return result;
}

}  // namespace perception
