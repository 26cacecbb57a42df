#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>

namespace perception {

/// Least squares over items in the order of time, each with the same number of residuals.
struct FitProblem {
  std::size_t items = 0;
  Eigen::Index rows = 0;  ///< residuals of an item; each row has its own, unknown noise
  double shared = 1;      ///< this many successive items rest on the same data
  Eigen::VectorXd start;
  Eigen::VectorXd mean, sigma;  ///< Gaussian prior of the parameters
  Eigen::VectorXd step;         ///< of numerical differentiation
  Eigen::VectorXd least;        ///< noise of a row is not below [rows]
  /// Residuals of an item; false: it says nothing.
  std::function<bool(std::size_t item, const Eigen::VectorXd& parameters, Eigen::VectorXd& r)>
      residuals;
};

struct FitResult {
  Eigen::VectorXd value;
  /// The larger of the Gaussian and the delete-one-block jackknife standard deviation (method.md
  /// 8.13).
  Eigen::VectorXd sigma;
  std::size_t used = 0;  ///< items
};

/// Gauss-Newton with Cauchy weights; noise of each row by its median residual. Empty with too few
/// items.
std::optional<FitResult> fitRobustly(const FitProblem& problem);

}  // namespace perception
