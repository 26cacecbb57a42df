#pragma once
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace perception {

inline constexpr double kMinusInfinity = -std::numeric_limits<double>::infinity();

/// log(exp(a) + exp(b)) without overflow; -inf is the log of zero.
inline double logAddExp(double a, double b) {
  const double high = std::max(a, b);
  return high == kMinusInfinity ? kMinusInfinity
                                : high + std::log1p(std::exp(std::min(a, b) - high));
}

/// log of the sum of exp over a range of doubles; -inf for an empty one.
template <class Range>
double logSumExp(const Range& values) {
  double high = kMinusInfinity;
  for (const double v : values) high = std::max(high, v);
  if (high == kMinusInfinity) return kMinusInfinity;
  double sum = 0;
  for (const double v : values) sum += std::exp(v - high);
  return high + std::log(sum);
}

/// Shifts log probabilities so that they sum to one. All -inf becomes uniform. Returns the log of
/// their former sum.
template <class Range>
double logNormalize(Range& values) {
  const double total = logSumExp(values);
  if (total == kMinusInfinity) {
    for (double& v : values) v = -std::log(static_cast<double>(std::size(values)));
  } else {
    for (double& v : values) v -= total;
  }
  return total;
}

inline double logit(double p) { return std::log(p / (1 - p)); }
inline double sigmoid(double x) {
  return x >= 0 ? 1 / (1 + std::exp(-x)) : std::exp(x) / (1 + std::exp(x));
}

}  // namespace perception
