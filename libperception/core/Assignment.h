#pragma once
#include <Eigen/Core>
#include <vector>

namespace perception {

/// The assignment of rows to columns with the smallest sum of costs that pairs min(rows, columns)
/// of them: entry r is the column of row r or -1. Costs are finite. Shortest augmenting paths with
/// potentials (Hungarian method), O(n^3).
std::vector<int> optimalAssignment(const Eigen::MatrixXd& cost);

}  // namespace perception
